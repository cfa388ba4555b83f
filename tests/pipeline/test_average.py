"""An observation is averaged over cells, and measured."""

import shutil
from dataclasses import dataclass, replace

import numpy as np
import pytest
from casacore import tables

from tests.io.measurement_sets import written
from tests.pipeline.fields import catalogue_of_sky, vla_field
from tests.progress.heard import Heard
from tests.skies import galaxies
from uvshear.constants import ARCMIN, ARCSEC
from uvshear.errors import InputError, NothingMeasuredWarning
from uvshear.execution import Resources, Serial
from uvshear.extraction import Model
from uvshear.galaxy import CatalogueSize, Exponential
from uvshear.geometry.directions import PhaseCentre
from uvshear.interferometer.coverage import Track, synthesise
from uvshear.interferometer.layout import load_layout
from uvshear.interferometer.noise import ScaledNoise
from uvshear.interferometer.spectral_window import Channels
from uvshear.io.measurement_set.writer import write_measurement_set
from uvshear.io.observations import open_observation
from uvshear.io.reading import Reading
from uvshear.pipeline.average import average
from uvshear.pipeline.measure import measure
from uvshear.simulation.observation import SimulatedObservation

CENTRE = PhaseCentre(0.3, np.radians(40.0))
SERIAL = Resources(Serial())

# Simulated visibilities without noise have less noise than their weights claim.
pytestmark = pytest.mark.filterwarnings("ignore:.*the noise is at most")
MODEL = Model(size=CatalogueSize())


@dataclass(frozen=True)
class Seen:
    truth: object
    observation: SimulatedObservation
    catalogue: object
    path: object
    averaged: object


def _observed(sky, seed=None, hours=1.0):
    half = hours * 1800
    return SimulatedObservation(
        coverage=synthesise(load_layout("vla-b"), Track.from_clock(CENTRE, ((-half, half),), 20.0)),
        channels=Channels.from_band(1.30e9, 1.36e9, 6),
        galaxies=sky,
        profile=Exponential(),
        noise=ScaledNoise(2e-4),
        seed=seed,
        is_averaged=True,
    )


@pytest.fixture(scope="module")
def seen(tmp_path_factory):
    angle = 2.4 * np.arange(5)
    radius = np.array([1.0, 4.0, 7.0, 9.0, 9.9]) * ARCMIN
    e = 0.3 * np.exp(1j * np.arange(5))
    sky = galaxies(radius * np.cos(angle), radius * np.sin(angle), 1e-2, 3 * ARCSEC, e)
    observation = _observed(sky)
    path = tmp_path_factory.mktemp("averaged") / "compact.ms"
    averaged = average(observation, path, field_arcmin=20, resources=SERIAL)
    return Seen(sky, observation, catalogue_of_sky(sky, CENTRE), path, averaged)


def _measured(seen, visibilities, model=MODEL):
    return measure(visibilities, seen.catalogue, model=model, resources=SERIAL).shapes


def _shapes(seen, visibilities):
    table = _measured(seen, visibilities)
    assert (table["flag"] == "ok").all()
    return np.array(table["e1"]) + 1j * np.array(table["e2"]), np.array(table["e1_err"])


def test_there_are_fewer_rows_with_the_same_weight(seen):
    total = sum(float(chunk.weights.sum()) for chunk in seen.observation.chunks())
    averages = list(open_observation(seen.path).chunks())
    assert sum(map(len, averages)) == seen.averaged.rows < 0.5 * seen.averaged.samples
    assert sum(float(chunk.weights.sum()) for chunk in averages) == pytest.approx(total, rel=1e-5)


def test_shapes_are_the_same_to_5e_4_and_so_are_their_errors(seen):
    direct, error = _shapes(seen, seen.observation)
    averaged, error_too = _shapes(seen, seen.path)
    e = seen.truth.ellipticity
    # 1.4e-4 with the averages, 2e-5 directly
    assert np.abs(averaged - e).max() < 5e-4
    assert np.abs(direct - e).max() < 1e-4
    np.testing.assert_allclose(error_too, error, rtol=0.03)


def test_without_their_loss_bright_sources_leave_a_residual(seen):
    with pytest.warns(NothingMeasuredWarning, match="contaminated"):
        table = _measured(seen, seen.path, replace(MODEL, smears=False))
    assert (table["flag"] == "contaminated").all()


def test_a_second_night_adds_samples_and_hardly_any_rows(seen, tmp_path):
    first, second = (_observed(seen.truth, seed=seed) for seed in (1, 2))
    one = average(first, tmp_path / "one.ms", field_arcmin=20, resources=SERIAL)
    nights = [tmp_path / "first.ms", tmp_path / "second.ms"]
    for path, night in zip(nights, (first, second), strict=True):
        write_measurement_set(path, night)
    both = average(nights, tmp_path / "two.ms", field_arcmin=20, resources=SERIAL)
    assert both.samples == 2 * one.samples
    assert both.rows == one.rows


def test_nights_with_other_antennas_are_averaged_together(tmp_path):
    path, other = written(tmp_path), tmp_path / "other.ms"
    shutil.copytree(path, other)
    with tables.table(str(other / "ANTENNA"), readonly=False, ack=False) as antennas:
        antennas.putcell("DISH_DIAMETER", 0, 25.0)
    one = average(path, tmp_path / "one.ms", field_arcmin=1, resources=SERIAL)
    both = average([path, other], tmp_path / "both.ms", field_arcmin=1, resources=SERIAL)
    assert both.samples == 2 * one.samples
    # The baselines of the changed antenna have rows of their own.
    assert one.rows < both.rows < 2 * one.rows
    diameters = open_observation(tmp_path / "both.ms").dish_diameters()
    assert 25.0 in diameters


def test_averages_are_not_averaged_again(seen, tmp_path):
    with pytest.raises(InputError, match="holds averages already"):
        average(seen.path, tmp_path / "again.ms", field_arcmin=20)
    assert not list(tmp_path.iterdir())


def test_averages_have_no_scans(seen):
    with pytest.raises(InputError, match="scans cannot be chosen"):
        open_observation(seen.path, Reading(scans=(1,)))


def test_without_a_weight_there_is_nothing_to_average(tmp_path):
    field = vla_field()
    blocks = [replace(part, weights=0 * part.weights) for part in field.observation.blocks]
    nothing = replace(field.observation, blocks=tuple(blocks))
    with pytest.raises(InputError, match="no visibility carries weight"):
        average(nothing, tmp_path / "compact.ms", field_arcmin=20, resources=SERIAL)
    assert not list(tmp_path.iterdir())


def test_reading_and_writing_are_stages(tmp_path):
    heard = Heard()
    observation = _observed(galaxies(0.0, 0.0, 1e-2, 3 * ARCSEC, 0.0), hours=0.1)
    average(observation, tmp_path / "c.ms", field_arcmin=20, resources=SERIAL, progress=heard)
    assert heard.stages == ["averaging", "writing"]
    count = sum(chunk.stokes_i.size for chunk in observation.chunks())
    at = heard.all.index(("begin", "writing", ()))
    read, written_cells = (
        [what for what in part if what[0] == "advance"] for part in (heard.all[:at], heard.all[at:])
    )
    assert read[-1] == ("advance", count, count)
    # Two or more nodes of most cells.
    assert written_cells[-1][1] == written_cells[-1][2] < count / 2
    assert ("foresee", "writing") in heard.all[:at]
    assert heard.all[-1] == ("finish",)


def test_flagged_samples_do_not_count(tmp_path):
    path = written(tmp_path)
    with tables.table(str(path), readonly=False, ack=False) as main:
        flags = main.getcol("FLAG")
        flags[::3] = True
        data = main.getcol("DATA")
        data[::3] = 1e5
        main.putcol("FLAG", flags)
        main.putcol("DATA", data)
    found = average(path, tmp_path / "compact.ms", field_arcmin=1, resources=SERIAL)
    assert found.samples == np.count_nonzero(~flags[..., 0])
    chunk = next(open_observation(tmp_path / "compact.ms").chunks())
    assert np.abs(chunk.stokes_i).max() < 1
