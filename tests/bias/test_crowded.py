"""A crowded field behind known shears, through the whole measurement."""

from dataclasses import replace

import numpy as np
import pytest

from tests.shear.test_bayesian import Toy
from uvshear.bias.crowded import (
    FieldBayesian,
    FieldMean,
    FieldMoments,
    calibrate_field,
)
from uvshear.bias.survey import Survey, calibrate_crowded
from uvshear.estimators.packing import pack
from uvshear.extraction import MeasurementOptions
from uvshear.extraction.extraction import Extracted
from uvshear.galaxy import DiscEllipticityPrior
from uvshear.geometry.directions import PhaseCentre
from uvshear.interferometer.coverage import Track
from uvshear.interferometer.layout import load_layout
from uvshear.interferometer.plan import ObservingPlan
from uvshear.interferometer.spectral_window import Channels
from uvshear.interferometer.uv_range import UvRange
from uvshear.shapes.measurement import FitFlag, ShapeMeasurement
from uvshear.shapes.weight import lensfit_weight

SHEARS = (0.03 * np.exp(0.25j * np.pi), -0.03 * np.exp(0.25j * np.pi))


@pytest.fixture(scope="module")
def crowd():
    """Twenty galaxies, four to a square arcminute."""
    track = Track.from_clock(PhaseCentre(0.0, np.radians(-30)), ((-14400.0, 14400.0),), 7200.0)
    plan = ObservingPlan(load_layout("ska-mid-aa4"), track, Channels.from_band(0.95e9, 1.19e9, 1))
    return Survey(plan, SHEARS, snr_min=10.0, seed=6).crowd(20, 4.0)


def test_moments_of_a_crowd_answer_to_the_shear(crowd):
    total = calibrate_crowded(crowd, [FieldMoments()], MeasurementOptions())[0][0]
    assert total.n + total.failed == 20
    # of twenty galaxies; the same noise behind both shears leaves what neighbours make of it
    assert np.all(total.m_err < 0.05)
    assert np.all(np.abs(total.m) < 4 * total.m_err + 0.01)
    assert np.all(np.abs(total.c) < 4 * total.c_err + 1e-3)


def _extracted(crowd, shapes, kept):
    measurements = {
        k: replace(ShapeMeasurement.failed(FitFlag.NO_PEAK), ellipticity=np.array([e.real, e.imag]))
        for k, e in enumerate(shapes)
    }
    covariance = 0.01 * np.eye(2)
    for k, one in measurements.items():
        if np.isfinite(one.ellipticity).all():
            measurements[k] = replace(one, covariance=covariance, flag=FitFlag.OK)
    return Extracted(measurements, crowd.galaxies, UvRange(), {}, kept)


def test_ellipticities_that_were_measured_are_summed_with_their_weights(crowd):
    shapes = np.full(20, 0.2 - 0.1j)
    shapes[3] = np.nan
    terms = FieldMean().terms(_extracted(crowd, shapes, {}), crowd.galaxies.flux, 0j)
    assert np.isnan(terms[3]).all()
    weight = lensfit_weight(np.array([0.1]), DiscEllipticityPrior())[0]
    expected = weight * np.array([0.2, -0.1, 1, 0, 0, 1])
    np.testing.assert_allclose(np.delete(terms, 3, axis=0), np.tile(expected, (19, 1)))


def test_a_fields_likelihoods_find_its_shears(crowd):
    """Rings without noise behind opposite shears, by a stand-in for the extraction."""
    seen = []

    def extract(_, lensed):
        likelihoods = [Toy(complex(e), 0.06, size=0.0).on_lattice() for e in lensed.ellipticity]
        kept = {k: pack(one) for k, one in enumerate(likelihoods)}
        seen.append(lensed)
        return _extracted(crowd, lensed.ellipticity, kept)

    everyone = replace(crowd, used=np.ones(20, bool))
    total = calibrate_field(everyone, [FieldBayesian()], extract)[0][0]
    assert len(seen) == 8
    assert np.all(np.abs(total.m) < 0.1)
    assert np.all(np.abs(total.c) < 2e-3)


def test_noise_and_its_opposite_are_about_the_same_sky(crowd):
    galaxies = crowd.galaxies
    both = [crowd.seen(galaxies, sign).blocks[0].stokes_i for sign in (1, -1)]
    silent = replace(crowd, noise=crowd.seen(replace(galaxies, flux=0 * galaxies.flux), 1))
    np.testing.assert_allclose(
        both[0] - both[1], 2 * silent.noise.blocks[0].stokes_i, rtol=0, atol=1e-5
    )
