"""Whether short baselines can be left out, judged by the errors of typical galaxies."""

import math

import numpy as np
import pytest
from astropy.table import Table

from tests.extraction.converged.gap_array import WAVELENGTH, gap_plan
from tests.skies import galaxies
from uvshear.constants import ARCSEC, MICROJANSKY, SPEED_OF_LIGHT
from uvshear.extraction import ConvergedExtraction, Method, Model
from uvshear.extraction.converged.short_baselines import Growth, Typical, are_dispensable
from uvshear.extraction.field import Field
from uvshear.galaxy import CatalogueSize, Exponential, SizePrior
from uvshear.geometry.directions import PhaseCentre
from uvshear.interferometer.coverage import Track, synthesise
from uvshear.interferometer.layout import load_layout
from uvshear.interferometer.noise import ScaledNoise
from uvshear.interferometer.samples import Samples
from uvshear.interferometer.summary import ObservationSummary
from uvshear.interferometer.uv_range import UvRange
from uvshear.pipeline.measure import measure
from uvshear.pipeline.simulate import simulate
from uvshear.shapes.measurement import FitFlag

PROFILE = Exponential()
LARGE = Typical(1e-4, math.log(3 * ARCSEC), 0.3)


def _field(uvw, weight=1e9, uv_range=None):
    """Only what the judgement looks at."""
    none, nobody = np.zeros(len(uvw)), np.zeros(1)
    probes = Samples(uvw, none + 0j, none + weight, none, none, none, np.zeros((len(uvw), 2), int))
    longest = float(np.hypot(*uvw[:, :2].T).max()) * 1.001
    summary = ObservationSummary(len(uvw), 3 * len(uvw), longest, 1e9, 1e9, 1.0, probes)
    return Field(
        nobody,
        nobody,
        galaxies(),
        SizePrior(nobody, nobody + 0.3),
        np.arange(1),
        np.full(1, FitFlag.OK, dtype=object),
        uv_range or UvRange(0.0, longest),
        summary,
        nobody,
        nobody,
        nobody + 1,
    )


def _array(name, frequency=1.07e9, dec=-30.0):
    track = Track.from_clock(PhaseCentre(0.3, math.radians(dec)), ((-14400.0, 14400.0),), 3600.0)
    uvw = synthesise(load_layout(name), track).uvw * frequency / SPEED_OF_LIGHT
    return uvw[np.random.default_rng(1).permutation(len(uvw))[:4096]]


def _errors(uvw, weight, galaxy):
    """Errors of (ln S, e1, e2, ln alpha) of a round exponential disc, with its priors, from closed derivatives."""
    x2 = (2 * math.pi * math.exp(galaxy.log_size)) ** 2 * np.array(
        [uvw[:, 0] ** 2, uvw[:, 1] ** 2, uvw[:, 0] * uvw[:, 1]]
    )
    q = x2[0] + x2[1]
    slope = -1.5 * (1 + q) ** -2.5
    by = np.stack(
        [(1 + q) ** -1.5, 2 * slope * (x2[0] - x2[1]), 4 * slope * x2[2], 2 * slope * q], axis=1
    )
    information = galaxy.flux**2 * weight * by.T @ by
    return np.sqrt(np.diag(np.linalg.inv(information + np.diag([0.01, 4.4, 4.4, 1 / 0.09]))))


@pytest.mark.parametrize("limit", [500.0, 2000.0, 6000.0])
def test_errors_grow_as_the_fisher_matrix_tells(limit):
    uvw = _array("ska-mid-aa2")
    field = _field(uvw)
    kept = np.hypot(*uvw[:, :2].T) >= limit
    # the samples are three times the probes
    growth = _errors(uvw[kept], 3e9, LARGE) / _errors(uvw, 3e9, LARGE)
    limits = (growth[0], max(growth[1:3]), growth[3])
    for k in range(3):
        for factor, is_allowed in ((1.001, True), (0.999, False)):
            allowed = Growth(*(g * (factor if j == k else 1.01) for j, g in enumerate(limits)))
            with pytest.MonkeyPatch.context() as patch:
                patch.setattr("uvshear.extraction.converged.short_baselines.DENSE_CORE", allowed)
                found = are_dispensable(field, [LARGE], PROFILE, limit, 1e9)
            assert found is is_allowed


@pytest.mark.parametrize("name", ["ska-mid-aa4", "ska-mid-aastar", "ska-mid-aa2", "meerkat"])
def test_the_short_baselines_of_a_dense_core_are_dispensable(name):
    assert are_dispensable(_field(_array(name)), [LARGE], PROFILE, 3000.0, 3e5)


def test_those_of_an_array_with_few_are_not():
    assert not are_dispensable(_field(_array("e-merlin", dec=50)), [LARGE], PROFILE, 3000.0, 3e5)


def test_what_is_outside_the_range_does_not_count():
    uvw = _array("e-merlin", dec=50)
    assert are_dispensable(
        _field(uvw, uv_range=UvRange(3000.0, 1e6)), [LARGE], PROFILE, 3000.0, 3e5
    )


def test_one_galaxy_that_suffers_is_enough():
    point = Typical(1e-4, math.log(0.01 * ARCSEC), 0.3)
    field = _field(_array("e-merlin", dec=50))
    assert are_dispensable(field, [point], PROFILE, 3000.0, 3e5)
    assert not are_dispensable(field, [point, LARGE], PROFILE, 3000.0, 3e5)


def test_nothing_to_leave_out_is_dispensable():
    assert are_dispensable(_field(_array("vla-a", dec=34)), [LARGE], PROFILE, 100.0, 3e5)


@pytest.fixture(scope="module")
def six_galaxies():
    rng = np.random.default_rng(3)
    table = Table(
        {
            "l": rng.uniform(-1, 1, 6) * np.radians(0.3),
            "m": rng.uniform(-1, 1, 6) * np.radians(0.3),
            "flux": 10.0 * rng.uniform(0.7, 1.5, 6) / MICROJANSKY,
            "scale_length": 10.0 * rng.uniform(0.8, 1.3, 6),
            "e1": rng.normal(0, 0.2, 6),
            "e2": rng.normal(0, 0.2, 6),
        }
    )
    table["flux"].unit = "uJy"
    return table


@pytest.fixture(scope="module")
def observation(six_galaxies):
    """Baselines of 174 wavelengths between the stations of pairs, and of more than 2500 between sites."""
    plan = gap_plan()
    length = np.hypot(*synthesise(plan.layout, plan.track).uvw[:, :2].T) / WAVELENGTH
    assert 100 < np.count_nonzero(length < 400) < 400 < len(length) / 10
    assert not ((length > 180) & (length < 1000)).any()
    return simulate(six_galaxies, plan, noise=ScaledNoise(8.0), seed=5)


def _measured(observation, table, shortest=None):
    method = Method(extraction=ConvergedExtraction(shortest=shortest))
    return measure(observation, table, model=Model(size=CatalogueSize()), method=method)


@pytest.mark.filterwarnings("ignore::uvshear.errors.DataWarning")
def test_an_array_with_a_gap_measures_flux_size_and_shape(observation, six_galaxies):
    measurement = _measured(observation, six_galaxies)
    found, truth = measurement.shapes, six_galaxies
    assert measurement.record["shortest_baseline"] == 0
    assert set(found["flag"]) == {"ok"}
    pulls = np.concatenate(
        [
            (found["flux_fit"] - truth["flux"]) / found["flux_fit_err"],
            (found["scale_length"] - truth["scale_length"]) / found["scale_length_err"],
            (found["e1"] - truth["e1"]) / found["e1_err"],
            (found["e2"] - truth["e2"]) / found["e2_err"],
        ]
    )
    assert np.abs(pulls).max() < 3.5
    assert 0.6 < np.sqrt(np.mean(pulls**2)) < 1.4
    assert (found["flux_fit_err"] / truth["flux"]).max() < 0.015


@pytest.mark.filterwarnings("ignore::uvshear.errors.DataWarning")
def test_without_the_short_ones_the_fluxes_are_lost(observation, six_galaxies):
    """This is what the limit by the sizes of the galaxies would do here: 507 wavelengths."""
    found = _measured(observation, six_galaxies, shortest=507.0).shapes
    wrong = np.abs(found["flux_fit"] / six_galaxies["flux"] - 1)
    assert np.count_nonzero(wrong > 0.2) >= 3


@pytest.mark.filterwarnings("ignore::uvshear.errors.DataWarning")
def test_a_sky_that_diverges_with_the_short_ones_is_measured_without(observation, six_galaxies):
    """Most of what is known of larger galaxies is on the short baselines, which couple all of them."""
    larger = six_galaxies.copy()
    larger["scale_length"] *= 2.5
    seen = simulate(larger, gap_plan(), noise=ScaledNoise(8.0), seed=5)
    record = _measured(seen, larger).record
    assert 174 < record["shortest_baseline"] < 400
    assert record["left_undone"] < 0.1
