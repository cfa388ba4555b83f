"""Shapes from an MSv4 store, beside those from the Measurement Set that it was made from."""

from pathlib import Path

import numpy as np
import pytest

from tests.io.msv4_stores import tree_of, write_tree
from tests.pipeline.fields import METHOD, MODEL, catalogue_of_sky
from uvshear.constants import ARCMIN, ARCSEC
from uvshear.galaxy import Exponential, Galaxies
from uvshear.geometry.directions import PhaseCentre
from uvshear.interferometer.coverage import Track, synthesise
from uvshear.interferometer.layout import load_layout
from uvshear.interferometer.noise import ScaledNoise
from uvshear.interferometer.spectral_window import Channels
from uvshear.io.measurement_set.writer import write_measurement_set
from uvshear.pipeline.measure import measure
from uvshear.simulation.observation import SimulatedObservation

ERRORS = {
    "e1": "e1_err",
    "e2": "e2_err",
    "scale_length": "scale_length_err",
    "flux_fit": "flux_fit_err",
}


@pytest.fixture(scope="module")
def field(tmp_path_factory: pytest.TempPathFactory):
    """A Measurement Set of three galaxies with smearing, its conversion, and the catalogue."""
    centre = PhaseCentre(0.3, float(np.radians(40.0)))
    sky = Galaxies(
        l=np.array([0.7, -1.5, 0.3]) * ARCMIN,
        m=np.array([0.5, 1.0, -2.0]) * ARCMIN,
        flux=np.array([2e-2, 1.2e-2, 8e-3]),
        scale_length=np.array([1.5, 1.0, 2.0]) * ARCSEC,
        ellipticity=np.array([0.3, -0.2j, 0.1 + 0.2j]),
        spectral_index=np.full(3, -0.7),
    )
    track = Track.from_clock(centre, ((-14400.0, 14400.0),), 1200.0)
    ms = tmp_path_factory.mktemp("sets") / "field.ms"
    write_measurement_set(
        ms,
        SimulatedObservation(
            coverage=synthesise(load_layout("vla-a"), track),
            channels=Channels.from_band(1.30e9, 1.34e9, 2),
            galaxies=sky,
            profile=Exponential(),
            noise=ScaledNoise(1e-3),
            seed=1,
            is_averaged=True,
        ),
    )
    store = write_tree(tree_of(ms), ms.with_name("field.ps.zarr"))
    return ms, store, catalogue_of_sky(sky, centre)


def test_shapes_of_both_versions_agree_to_a_millionth_of_their_errors(field) -> None:
    ms, store, catalogue = field
    first = measure(ms, catalogue, model=MODEL, method=METHOD).shapes
    second = measure(store, catalogue, model=MODEL, method=METHOD).shapes
    assert set(first["flag"]) == {"ok"}
    for name, error in ERRORS.items():
        difference = np.abs(np.asarray(first[name]) - np.asarray(second[name]))
        assert (difference < 1e-6 * np.asarray(first[error])).all(), name


def test_a_set_and_a_store_of_the_same_field_are_measured_together(field, tmp_path: Path) -> None:
    ms, store, catalogue = field
    alone = measure(store, catalogue, model=MODEL, method=METHOD).shapes
    both = measure([ms, store], catalogue, model=MODEL, method=METHOD).shapes
    # Twice the data have errors smaller by the root of two, and the noise is the same.
    ratio = np.asarray(both["e_sigma"]) / np.asarray(alone["e_sigma"])
    np.testing.assert_allclose(ratio, 2**-0.5, rtol=0.03)
