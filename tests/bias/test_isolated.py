"""Biases of estimators on isolated galaxies: small versions of what docs/algorithm.md claims."""

from dataclasses import replace

import numpy as np
import pytest
from uvshear.bias.bias import fit_bias
from uvshear.bias.estimators import (
    BayesianEstimator,
    Estimator,
    MeanEstimator,
    MetacalEstimator,
    MomentEstimator,
    Seen,
    SelectedEstimator,
)
from uvshear.bias.experiment import TURNED, Experiment, calibrate, sums_of
from uvshear.extraction.keep import MomentStatistic

from uvshear.bias.cell_average import LADDER
from uvshear.bias.survey import Survey
from uvshear.constants import ARCSEC
from uvshear.errors import InputError
from uvshear.execution import in_threads
from uvshear.extraction import MeasurementOptions
from uvshear.extraction.paper.cell_average import CellAverageFacets
from uvshear.extraction.paper.facets import Target
from uvshear.galaxy import Exponential, Galaxies, PowerLawFlux, Sersic
from uvshear.geometry.directions import PhaseCentre
from uvshear.interferometer.coverage import Track
from uvshear.interferometer.layout import load_layout
from uvshear.interferometer.plan import ObservingPlan
from uvshear.interferometer.spectral_window import Channels
from uvshear.interferometer.uv_range import UvRange
from uvshear.io.catalogue import catalogue_from_galaxies
from uvshear.pipeline import extract, simulate
from uvshear.shapes.measurement import GalaxyFit
from uvshear.shapes.metacal import STEP
from uvshear.shapes.moments import MomentFunctional
from uvshear.shapes.prior import ShapePrior
from uvshear.simulation.lensing import shear_at_fixed_scale_length
from uvshear.simulation.population import Population

SHEARS = (0.03 * np.exp(0.25j * np.pi), -0.03 * np.exp(0.25j * np.pi))


def _plan(declination=-30.0):
    centre = PhaseCentre(0.0, np.radians(declination))
    track = Track.from_clock(centre, ((-14400.0, 14400.0),), 1800.0)
    return ObservingPlan(load_layout("ska-mid-aa4"), track, Channels.from_band(0.95e9, 1.19e9, 1))


@pytest.fixture(scope="module")
def beam():
    return Survey(_plan(), SHEARS).alone().beam


@pytest.fixture(scope="module")
def experiment(beam):
    return Experiment(beam, SHEARS, seed=3)


@pytest.fixture(scope="module")
def moments():
    """One for all tests: it keeps its weights."""
    return MomentEstimator()


def test_moments_have_no_bias_at_any_flux(experiment, moments):
    for one in calibrate(experiment, moments, 100):
        # noise cancels between +n and -n, shapes between e and -e
        assert np.all(one.m_err < 1.5e-3)
        assert np.all(np.abs(one.m) < 1e-3 + 2 * one.m_err)
        assert np.all(np.abs(one.c) < 2e-4)


def test_moments_have_no_bias_of_the_third_order(experiment, moments):
    strong = replace(experiment, shears=tuple(5 * g for g in SHEARS))
    total = calibrate(strong, moments, 100)[0]
    # |g| is 0.15: without the third order m would be 0.03
    assert np.all(total.m_err < 4e-3)
    assert np.all(np.abs(total.m) < 2e-3 + 2 * total.m_err)


def test_moments_do_not_know_the_profile(experiment, moments):
    other = replace(experiment, profile=Sersic(2.0))
    total = calibrate(other, moments, 100)[0]
    assert np.all(total.m_err < 2e-3)
    assert np.all(np.abs(total.m) < 5e-3)


def test_moments_bear_known_errors_of_the_position(experiment, moments):
    sigma = 0.3 * ARCSEC
    scattered = replace(experiment, position_sigma=sigma)
    known = calibrate(scattered, MomentEstimator(sigma), 200)[0]
    assert np.all(np.abs(known.m) < 3e-3 + 3 * known.m_err)


def test_processes_change_no_bit(experiment, moments):
    alone = calibrate(experiment, moments, 100)
    together = calibrate(experiment, moments, 100, executor=in_threads(2))
    for one, other in zip(alone, together, strict=True):
        assert one.record() == other.record()


@pytest.fixture(scope="module")
def bright(beam):
    population = Population(flux=PowerLawFlux(minimum=50e-6, maximum=200e-6))
    return Experiment(beam, SHEARS, population=population, seed=3)


def test_the_bayesian_estimate_of_bright_galaxies_is_the_shear(bright):
    bayesian = sums_of(bright, BayesianEstimator(), SHEARS, 0, 24).values.sum(axis=0)
    got = fit_bias("all", SHEARS, SHEARS, np.array([bayesian, bayesian]), 24)
    # jackknife over 200 galaxies: 0.01; the sign or a factor of the response wrong: 1
    assert np.all(np.abs(got.m) < 0.1)
    assert np.all(np.abs(got.c) < 0.02)


def test_a_first_guess_of_few_galaxies_is_kept_within_reach(experiment):
    """Without that a shear of 2 was expanded about, where there is none."""
    seen_about = []

    class Wild(Estimator):
        is_expanded = True

        def term(self, seen):
            seen_about.append(seen.about)
            return np.array([2.0, -1.0]), np.eye(2)

    calibrate(replace(experiment, has_rings=False), Wild(), 100)
    assert max(abs(one) for one in seen_about) == pytest.approx(0.3)


def test_a_narrow_cut_leaves_enough_galaxies_for_a_first_guess(experiment):
    counted = {}

    class Counting(Estimator):
        is_expanded = True

        def term(self, seen):
            counted[seen.about] = counted.get(seen.about, 0) + 1
            return np.array([0.01, 0.0]), np.eye(2)

    narrow = replace(experiment, flux_min=150e-6, has_rings=False, shears=SHEARS)
    calibrate(narrow, Counting(), 5000)
    # behind both shears, with both signs of the noise
    assert counted[0j] / 4 > 80


def test_the_papers_shear_moves_no_sizes_and_shows_it(bright, moments):
    """A lens that leaves alpha is none: the response of moments to it is less by a tenth or so."""
    legacy = replace(bright, lens=shear_at_fixed_scale_length)
    true = calibrate(bright, moments, 100)[0]
    wrong = calibrate(legacy, moments, 100)[0]
    assert np.all(np.abs(true.m) < 3e-3)
    assert np.all(wrong.m < -0.03)


def test_the_mean_of_faint_galaxies_is_biased_by_noise(beam, moments):
    """And moments of the same galaxies with the same noise are not; the mean loses a third of the shear."""
    population = Population(flux=PowerLawFlux(minimum=10e-6, maximum=15e-6))
    faint = Experiment(beam, SHEARS, population=population, seed=5)
    mean = sums_of(faint, MeanEstimator(), SHEARS, 0, 30).values.sum(axis=0)
    none = (0j, 0j)
    biased = fit_bias("mean", SHEARS, none, np.array([mean, mean]), 30)
    linear = sums_of(faint, moments, SHEARS, 0, 30).values.sum(axis=0)
    exact = fit_bias("moments", SHEARS, SHEARS, np.array([linear, linear]), 30)
    assert biased.m.mean() < -0.15
    assert np.all(np.abs(exact.m) < 5e-3)


def test_metacal_of_moments_is_what_their_analytic_response_says(experiment, moments):
    """Of the same galaxies and noise, by differences of sheared data."""
    strong = replace(experiment, has_rings=False)
    total = calibrate(strong, MetacalEstimator(moments), 100)[0]
    # both signs of all noise; the third order is 0.002
    assert np.all(total.m_err < 0.015)
    assert np.all(np.abs(total.m) < 8e-3)


def test_metacal_finds_the_response_that_an_estimator_has_wrong(experiment, moments):
    class Wrong(Estimator):
        """Moments that take themselves for a third more responsive than they are."""

        is_expanded = True

        def term(self, seen):
            value, response = moments.term(replace(seen, about=0j))
            about = np.array([seen.about.real, seen.about.imag])
            return value - 1.3 * response @ about, 1.3 * response

    strong = replace(experiment, has_rings=False)
    wrong, mended = (calibrate(strong, one, 100)[0] for one in (Wrong(), MetacalEstimator(Wrong())))
    # -0.3/1.3, and a third order
    assert np.all(wrong.m < -0.2)
    assert np.all(np.abs(mended.m) < 8e-3)


def test_metacal_of_the_mean_of_bright_galaxies_finds_the_shear(bright):
    """A response of a wrong sign, or off by a fifth, is seen; the noise bias of faint ones takes thousands of them."""
    strong = replace(bright, shears=(0.1 + 0j, -0.1 + 0j), has_rings=False)
    about = (0j, 0j)
    values = sums_of(strong, MetacalEstimator(MeanEstimator()), about, 0, 30).values.sum(axis=0)
    got = fit_bias("all", strong.shears, about, np.array([values, values]), 30)
    assert abs(got.m[0]) < 0.15


def test_a_measurement_that_fails_counts_as_nothing_in_metacal(beam):
    """What shear makes fail is part of the response."""

    class Fickle(Estimator):
        calls = 0

        def term(self, seen):
            self.calls += 1
            return None if self.calls == 3 else (np.array([0.1, 0.0]), np.eye(2))

    stage = beam.stage(np.log(1.0 * ARCSEC), 0.3)
    galaxy = GalaxyFit(2e-5, np.zeros(2), 0.1 + 0j, 5e-6, 0.0)
    noise = stage.noise(np.random.default_rng(2))
    facet = stage.facet(galaxy, Exponential(), noise)
    seen = Seen(facet, stage, ShapePrior(np.log(1.0 * ARCSEC), 0.3), 2e-5, 0j, noise)
    value, response = MetacalEstimator(Fickle()).term(seen)
    np.testing.assert_array_equal(value, [0.1, 0.0])
    np.testing.assert_allclose(response, [[0.1 / (2 * STEP), 0], [0, 0]])


def test_cell_averages_of_the_calibration_are_those_of_the_extraction():
    """One galaxy at the phase centre, through its visibilities and drawn."""
    plan = _plan()
    beam = Survey(plan, SHEARS).alone(averages_cells=True).beam
    flux, alpha, e = 5e-5, 1.0 * ARCSEC, 0.3 - 0.2j
    sky = Galaxies(
        l=np.zeros(1),
        m=np.zeros(1),
        flux=np.array([flux]),
        scale_length=np.array([alpha]),
        ellipticity=np.array([e]),
        spectral_index=np.zeros(1),
    )
    catalogue = catalogue_from_galaxies(sky, plan.track.phase_centre)
    visibilities = list(simulate(catalogue, plan, seed=None).chunks())
    stage = beam.stage(np.log(alpha), 0.3)
    nothing = np.zeros(len(stage.power), complex)
    drawn = stage.facet(GalaxyFit(flux, np.zeros(2), e, alpha, 0.0), Exponential(), nothing)
    rung = LADDER ** np.ceil(np.log(alpha) / np.log(LADDER))
    uv_range = UvRange(0.0, beam.longest)
    target = Target(sky, rung, uv_range, beam.frequency)
    builder = CellAverageFacets().open(target, Exponential())
    for block in visibilities:
        builder.add(block, replace(sky, flux=np.zeros(1)))
    facet = builder.facet(sky)
    np.testing.assert_allclose(drawn.uv, facet.uv, rtol=1e-6)
    np.testing.assert_allclose(drawn.power, facet.power, rtol=1e-6)
    scale = np.abs(facet.correlation).max()
    np.testing.assert_allclose(drawn.correlation, facet.correlation, atol=1e-5 * scale)


def test_galaxies_are_drawn_by_their_numbers(experiment, moments):
    first = sums_of(experiment, moments, SHEARS, 50, 10)
    again = sums_of(experiment, moments, SHEARS, 50, 10)
    other = sums_of(experiment, moments, SHEARS, 100, 10)
    assert np.array_equal(first.values, again.values)
    assert not np.array_equal(first.values, other.values)


def test_a_cut_on_the_catalogues_flux_leaves_out_the_faint(experiment, moments):
    every = sums_of(experiment, moments, SHEARS, 0, 50).count.sum()
    some = sums_of(replace(experiment, snr_min=20.0), moments, SHEARS, 0, 50).count.sum()
    assert 0 < some < every == 50


def test_shears_that_do_not_cancel_are_refused(beam):
    with pytest.raises(InputError, match="add up to zero"):
        Experiment(beam, (0.02 + 0j, 0.02j))


def test_what_is_drawn_is_what_visibilities_come_to(beam):
    """Moments of a galaxy from its visibilities, through the whole measurement, and from the beam alone."""
    flux, e, alpha = 5e-5, 0.3 - 0.2j, 1.4 * ARCSEC
    sky = Galaxies(
        l=np.zeros(1),
        m=np.zeros(1),
        flux=np.array([flux]),
        scale_length=np.array([alpha]),
        ellipticity=np.array([e]),
        spectral_index=np.array([-0.7]),
    )
    plan = _plan()
    catalogue = catalogue_from_galaxies(sky, plan.track.phase_centre)
    observation = simulate(catalogue, plan, seed=None)
    options = MeasurementOptions(keep=(MomentStatistic(),))
    _, extracted = extract(observation, catalogue, options)
    kept = extracted.kept[0]

    size = Population().size.prior(sky.flux)
    stage = beam.stage(float(size.log_median[0]), float(size.sigma[0]))
    functional = MomentFunctional(
        stage.cutout.uv, stage.power, stage.cutout.size * stage.cutout.pixel
    )
    galaxy = GalaxyFit(flux, np.zeros(2), e, alpha, 0.0)
    nothing = np.zeros(len(stage.power), complex)
    drawn = functional.measure(stage.facet(galaxy, Exponential(), nothing).correlation)

    scale = drawn.size
    names = ("m1", "m2", "m_size", "r11", "r12", "r22", "r_third")
    got = np.array([kept[name] for name in names]) / scale
    responses = drawn.response.ravel()[[0, 1, 3]]
    expected = np.array([*drawn.shape, drawn.size, *responses, drawn.third]) / scale
    # measured 4e-3 in the derivatives, of the track's few samples and the baselines left out below 3 kilo-wavelengths
    np.testing.assert_allclose(got, expected, atol=6e-3)
    noise = np.sqrt([kept["m1_var"], kept["m2_var"]])
    np.testing.assert_allclose(noise, np.sqrt(np.diag(drawn.covariance)[:2]), rtol=0.1)


def test_a_turned_sky_cancels_all_but_the_beams_own_direction(beam):
    """Of a beam that a turn does not change nothing is left, not even of one galaxy with its noise."""
    stage = beam.stage(np.log(1.0 * ARCSEC), 0.3)
    turned_power = stage.turned(stage.power.astype(complex)).real
    same = replace(stage, power=(stage.power + turned_power) / 2)
    prior = ShapePrior(np.log(1.0 * ARCSEC), 0.3)
    noise = stage.noise(np.random.default_rng(2))
    galaxies = Experiment(beam, (0j,)).draw(1, np.random.default_rng(3))

    def left(one, takes):
        terms = []
        for take in takes:
            seen = take.galaxies(galaxies)
            galaxy = GalaxyFit(2e-5, np.zeros(2), complex(seen.ellipticity[0]), 5e-6, 0.0)
            facet = one.facet(galaxy, Exponential(), take.noise(one, noise))
            terms.append(MeanEstimator().term(Seen(facet, one, prior, 2e-5, 0j, noise))[0])
        return np.abs(np.sum(terms, axis=0)).max() / np.abs(terms).max()

    assert len(TURNED) == 8
    # measured 4e-3, of the posterior's lattice; 0.5 of the real beam
    assert left(same, TURNED) < 8e-3
    assert left(stage, TURNED) > 20 * left(same, TURNED)
    # shapes and noise of both signs alone leave the second order of the noise: 0.4
    assert left(same, TURNED[:4]) > 0.1


def test_noise_comes_back_after_four_turns(beam):
    stage = beam.stage(np.log(1.0 * ARCSEC), 0.3)
    noise = stage.noise(np.random.default_rng(2))
    again = noise
    for _ in range(4):
        again = stage.turned(again)
    np.testing.assert_array_equal(again, noise)


def test_without_shear_only_the_additive_bias_is_told(beam, moments):
    one = calibrate(Experiment(beam, (0j,), seed=3), moments, 100)[0]
    record = one.record()
    assert "m1" not in record
    assert abs(record["c1"]) < 1e-4


def test_the_beams_ellipticity_leaks_into_the_mean_and_not_into_moments():
    """Sixty degrees from zenith, faint galaxies without a shear."""
    beam = Survey(_plan(29.3), (0j,)).alone().beam
    population = Population(flux=PowerLawFlux(minimum=10e-6, maximum=15e-6))
    faint = Experiment(beam, (0j,), population=population, seed=5)

    def c1(estimator, number):
        values = sums_of(faint, estimator, (0j,), 0, number).values.sum(axis=0)
        return fit_bias("all", (0j,), (0j,), np.array([values, values]), number).c[0]

    assert c1(MeanEstimator(), 25) < -0.004
    assert abs(c1(MomentEstimator(), 25)) < 2e-4


def test_galaxies_below_a_flux_are_left_out(experiment, moments):
    every = sums_of(experiment, moments, SHEARS, 0, 50).count
    some = sums_of(replace(experiment, flux_min=50e-6), moments, SHEARS, 0, 50).count
    np.testing.assert_array_equal(some[:3], [0, 0, every[2]])


def test_fluxes_of_no_bin_are_in_the_total_alone(experiment, moments):
    beyond = replace(
        experiment,
        population=Population(flux=PowerLawFlux(minimum=300e-6, maximum=400e-6)),
    )
    total, *bins = calibrate(beyond, moments, 100)
    assert total.n == 100
    assert not bins


def test_a_cut_on_what_was_measured_takes_galaxies_out_look_by_look(experiment, moments):
    everyone = sums_of(experiment, moments, SHEARS, 0, 12).values
    same = sums_of(experiment, SelectedEstimator(moments, 0.0), SHEARS, 0, 12)
    np.testing.assert_array_equal(same.values, everyone)
    nobody = sums_of(experiment, SelectedEstimator(moments, 1e6), SHEARS, 0, 12)
    assert not nobody.values.any()
    assert not nobody.failed.any()
    some = sums_of(experiment, SelectedEstimator(moments, 20.0), SHEARS, 0, 12).values
    assert 0 < some[:, :, 2].sum() / everyone[:, :, 2].sum() < 1


def test_without_rings_each_galaxy_is_seen_twice_behind_a_shear(experiment):
    assert len(experiment.takes) == 4
    assert len(replace(experiment, has_rings=False).takes) == 2
