"""A measurement whose blocks, fits and statistics are shared by a cluster."""

import numpy as np
import pytest

from tests.pipeline.fields import METHOD, MODEL, catalogue_of_sky
from tests.skies import galaxies
from uvshear.constants import ARCMIN, ARCSEC
from uvshear.execution import Copies, Dask, Resources, Serial
from uvshear.galaxy import Exponential
from uvshear.geometry.directions import PhaseCentre
from uvshear.interferometer.coverage import Track, synthesise
from uvshear.interferometer.layout import load_layout
from uvshear.interferometer.noise import ScaledNoise
from uvshear.interferometer.spectral_window import Channels
from uvshear.io.measurement_set.observation import MeasurementSet
from uvshear.io.measurement_set.writer import write_measurement_set
from uvshear.pipeline.measure import measure
from uvshear.simulation.observation import SimulatedObservation

CENTRE = PhaseCentre(0.3, np.radians(40.0))
SKY = galaxies(
    np.array([1.0, -2.0, 0.5]) * ARCMIN,
    np.array([0.5, 1.0, -2.5]) * ARCMIN,
    np.array([4.0, 3.0, 2.0]) * 1e-3,
    np.array([2.0, 3.0, 2.5]) * ARCSEC,
    np.array([0.3, -0.2j, 0.1 + 0.2j]),
)


@pytest.fixture(scope="module")
def observed(tmp_path_factory) -> MeasurementSet:
    """A set of several chunks."""
    track = Track.from_clock(CENTRE, ((-7200.0, 7200.0),), 240.0)
    path = tmp_path_factory.mktemp("blocks") / "field.ms"
    observation = SimulatedObservation(
        coverage=synthesise(load_layout("vla-b"), track),
        channels=Channels.from_band(1.35e9, 1.45e9, 2),
        galaxies=SKY,
        profile=Exponential(),
        noise=ScaledNoise(1e-3),
        seed=1,
    )
    write_measurement_set(path, observation)
    return MeasurementSet(path, memory=2**18)


def _values(table) -> list[bytes]:
    return [np.asarray(value).tobytes() for name in table.colnames for value in table[name]]


def test_a_set_of_several_blocks_is_measured_alike_by_all_executors(observed, client, monkeypatch):
    monkeypatch.setattr("uvshear.predict.gridded.BLOCK", 10_000)
    catalogue = catalogue_of_sky(SKY, CENTRE)
    found = [
        measure(
            observed,
            catalogue,
            model=MODEL,
            method=METHOD,
            keep="moments",
            resources=Resources(executor),
        )
        for executor in (Serial(), Copies(2), Dask(client, Copies(2)))
    ]
    assert list(found[0].shapes["flag"]) == ["ok"] * 3
    for other in found[1:]:
        assert _values(other.shapes) == _values(found[0].shapes)
        assert _values(other.statistics) == _values(found[0].statistics)
        assert other.record == found[0].record
