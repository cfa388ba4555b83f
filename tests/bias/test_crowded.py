"""A crowded field behind known shears, through the whole measurement."""

from dataclasses import replace

import numpy as np
import pytest
from astropy.table import Table

from tests.bias.surveys import SHEARS, plan
from tests.estimators.test_evidence import Toy
from tests.progress.heard import Heard
from uvshear.bias.crowded import estimate_crowded_bias
from uvshear.bias.survey import Survey
from uvshear.errors import InputError
from uvshear.estimators.bayesian import Bayesian
from uvshear.estimators.mean import Mean
from uvshear.estimators.packing import pack
from uvshear.execution import SERIAL, Resources
from uvshear.geometry.directions import PhaseCentre, local_north
from uvshear.geometry.ellipticity import add_shear, to_field_frame
from uvshear.io.catalogue import catalogue_from_galaxies
from uvshear.io.statistics import statistics_table
from uvshear.pipeline.measure import measure
from uvshear.pipeline.measurement import Measurement


@pytest.fixture(scope="module")
def crowd():
    """Twenty galaxies, four to a square arcminute."""
    return Survey(plan(integration=7200.0), snr_min=10.0).crowd(SHEARS, 20, 4.0, seed=6)


@pytest.mark.long
def test_moments_of_a_crowd_answer_to_the_shear(crowd, moments):
    def measured(observation, lensed, progress):
        catalogue = catalogue_from_galaxies(lensed, observation.phase_centre)
        return measure(observation, catalogue, keep=(moments,), resources=Resources(SERIAL))

    done = []
    (total,) = estimate_crowded_bias(
        crowd, [moments], measured, lambda now, there_is: done.append((now, there_is))
    )
    assert total.n + total.failed == 20
    # of twenty galaxies; the same noise behind both shears leaves what neighbours make of it
    assert np.all(total.m_err < 0.05)
    assert np.all(np.abs(total.m) < 4 * total.m_err + 0.01)
    assert np.all(np.abs(total.c) < 4 * total.c_err + 1e-3)
    assert done == [(k, 8) for k in range(1, 9)]


def _measurement(crowd, shapes, kept=None, estimator=None, centre=None):
    """What a measurement would give that found these ellipticities; NaN where it failed."""
    galaxies = crowd.galaxies
    centre = centre or crowd.noise.phase_centre
    table = Table(
        {
            "id": np.arange(len(galaxies)).astype(str),
            "l": galaxies.l,
            "m": galaxies.m,
            "flux": galaxies.flux / 1e-6,
            "e1": shapes.real,
            "e2": shapes.imag,
            "weight": np.linspace(1, 2, len(galaxies)),
            "snr": np.full(len(galaxies), 20.0),
            "flag": np.where(np.isfinite(shapes), "ok", "no_peak"),
        }
    )
    table.meta = {"ra0_deg": np.degrees(centre.ra), "dec0_deg": np.degrees(centre.dec)}
    statistics = None if kept is None else statistics_table(table, [estimator], kept)
    return Measurement(table, statistics, None, {})


def test_ellipticities_that_were_measured_are_summed_with_their_weights(crowd):
    """A galaxy that fails once is left out of all; the mean of e and -e behind a shear is known."""

    def measured(observation, lensed, progress):
        shapes = lensed.ellipticity.copy()
        shapes[3] = np.nan
        return _measurement(crowd, shapes)

    everyone = replace(crowd, used=np.ones(20, bool))
    (total,) = estimate_crowded_bias(everyone, [Mean()], measured)
    assert (total.n, total.failed) == (19, 1)
    weight = np.delete(np.linspace(1, 2, 20), 3)
    e = np.delete(crowd.galaxies.ellipticity, 3)
    north = np.delete(local_north(crowd.noise.phase_centre, crowd.galaxies.l, crowd.galaxies.m), 3)
    g = to_field_frame(np.full(19, SHEARS[0]), north)
    behind = (add_shear(e, g) + add_shear(-e, g)) / 2
    expected = np.average(np.conj(behind * np.exp(2j * north)), weights=weight)
    # behind the opposite shear the mean is the opposite
    np.testing.assert_allclose(total.m[0], expected.real / SHEARS[0].real - 1, atol=1e-10)
    np.testing.assert_allclose(total.m[1], expected.imag / SHEARS[0].imag - 1, atol=1e-10)
    np.testing.assert_allclose(total.c, 0, atol=1e-12)


def test_shears_of_the_sky_stay_what_they_are_near_a_pole(crowd):
    """Local North turns by 10 degrees over the field; circles behind the shear show nothing but it."""
    centre = PhaseCentre(0.3, np.radians(89.9))
    noise = replace(crowd.noise, phase_centre=centre)
    circles = replace(crowd.galaxies, ellipticity=np.zeros(20, complex))
    polar = replace(crowd, galaxies=circles, noise=noise, used=np.ones(20, bool))
    assert np.ptp(local_north(centre, circles.l, circles.m)) > np.radians(10)

    def measured(observation, lensed, progress):
        return _measurement(crowd, lensed.ellipticity, centre=centre)

    (total,) = estimate_crowded_bias(polar, [Mean()], measured)
    np.testing.assert_allclose(total.m, 0, atol=1e-9)
    np.testing.assert_allclose(total.c, 0, atol=1e-12)


def test_a_fields_likelihoods_find_its_shears(crowd):
    """Rings without noise behind opposite shears, by a stand-in for the measurement."""
    seen = []

    def measured(observation, lensed, progress):
        likelihoods = [Toy(complex(e), 0.06, size=0.0).on_lattice() for e in lensed.ellipticity]
        kept = {k: pack(likelihood) for k, likelihood in enumerate(likelihoods)}
        seen.append(lensed)
        return _measurement(crowd, lensed.ellipticity, kept, Bayesian())

    everyone = replace(crowd, used=np.ones(20, bool))
    (total,) = estimate_crowded_bias(everyone, [Bayesian()], measured)
    assert len(seen) == 8
    assert np.all(np.abs(total.m) < 0.1)
    assert np.all(np.abs(total.c) < 2e-3)


def test_every_field_is_a_stage_in_which_its_measurement_goes_on(crowd):
    heard = Heard()

    def measured(observation, lensed, progress):
        progress(1, 4)
        return _measurement(crowd, lensed.ellipticity)

    estimate_crowded_bias(replace(crowd, used=np.ones(20, bool)), [Mean()], measured, heard)
    assert heard.stages == [f"field {number} of 8" for number in range(1, 9)]
    assert heard.all[0][2] == tuple(heard.stages[1:])
    assert [what[1:] for what in heard.all if what[0] == "advance"] == 8 * [(0.25, 1), (1, 1)]


def test_noise_and_its_opposite_are_about_the_same_sky(crowd):
    galaxies = crowd.galaxies
    both = [crowd.observed(galaxies, sign).blocks[0].stokes_i for sign in (1, -1)]
    silent = replace(crowd, noise=crowd.observed(replace(galaxies, flux=0 * galaxies.flux), 1))
    np.testing.assert_allclose(
        both[0] - both[1], 2 * silent.noise.blocks[0].stokes_i, rtol=0, atol=1e-5
    )


def test_an_estimator_that_learns_is_refused_before_anything_is_measured(crowd):
    with pytest.raises(InputError, match="'bayesian' fits its population to a sample"):
        estimate_crowded_bias(crowd, [Bayesian(fits_population=True)], measure)
