"""Biases of estimators on isolated galaxies: small versions of what docs/validation.md claims."""

from dataclasses import dataclass, field, replace

import numpy as np
import pytest

from tests.bias.surveys import SHEARS, plan
from uvshear.bias import isolated
from uvshear.bias.fit import TermSums, fit_bias
from uvshear.bias.isolated import (
    Experiment,
    estimate_isolated_bias,
    mock_galaxies,
    sum_terms,
)
from uvshear.bias.realisations import TURNED
from uvshear.bias.survey import Survey
from uvshear.constants import ARCSEC
from uvshear.errors import InputError
from uvshear.estimators.bayesian import Bayesian
from uvshear.estimators.estimator import Estimator
from uvshear.estimators.mean import Mean
from uvshear.estimators.metacal import Metacal
from uvshear.estimators.moments import Moments
from uvshear.estimators.terms import Terms
from uvshear.execution import Copies, Processes, Threads
from uvshear.galaxy import PowerLawFlux, Sersic
from uvshear.simulation.lensing import shear_at_fixed_scale_length
from uvshear.simulation.population import Population

NONE = (0j, 0j)


def _bias(experiment, estimator, about, number):
    """Bias of a few galaxies, which are a block twice: without an error."""
    sums = sum_terms(experiment, estimator, about, 0, number).values.sum(axis=0)
    return fit_bias(TermSums(np.array([sums, sums]), number), {}, experiment.shears, about)


def test_moments_have_no_bias_at_any_flux(experiment, moments):
    total = estimate_isolated_bias(experiment, moments, 100)
    assert [part.name for part in total.bins] == ["10-20 uJy", "20-50 uJy", "50-200 uJy"]
    for part in (total, *total.bins):
        # noise cancels between +n and -n, shapes between e and -e
        assert np.all(part.m_err < 1.5e-3)
        assert np.all(np.abs(part.m) < 1e-3 + 2 * part.m_err)
        assert np.all(np.abs(part.c) < 2e-4)
    assert total.frame == "sky"


def test_moments_have_no_bias_of_the_third_order(experiment, moments):
    strong = replace(experiment, shears=tuple(5 * g for g in SHEARS))
    total = estimate_isolated_bias(strong, moments, 100)
    # |g| is 0.15: without the third order m would be 0.03
    assert np.all(total.m_err < 4e-3)
    assert np.all(np.abs(total.m) < 2e-3 + 2 * total.m_err)


def test_moments_do_not_know_the_profile(experiment, moments):
    other = replace(experiment, profile=Sersic(2.0))
    total = estimate_isolated_bias(other, moments, 100)
    assert np.all(total.m_err < 2e-3)
    assert np.all(np.abs(total.m) < 5e-3)


@pytest.mark.long
def test_moments_bear_known_errors_of_the_position(experiment):
    sigma = 0.3 * ARCSEC
    scattered = replace(experiment, position_sigma=sigma)
    known = estimate_isolated_bias(scattered, Moments(sigma), 200)
    assert np.all(np.abs(known.m) < 3e-3 + 3 * known.m_err)


@pytest.mark.long
@pytest.mark.parametrize("executor", [Threads(2), Processes(2), Copies(2)])
def test_the_executor_changes_no_bit(experiment, moments, executor):
    alone = estimate_isolated_bias(experiment, moments, 100)
    together = estimate_isolated_bias(experiment, moments, 100, executor)
    assert alone.record() == together.record()
    for first, second in zip(alone.bins, together.bins, strict=True):
        assert first.record() == second.record()


def test_the_bayesian_estimate_of_bright_galaxies_is_the_shear(bright):
    got = _bias(bright, Bayesian(), SHEARS, 24)
    # jackknife over 200 galaxies: 0.01; the sign or a factor of the response wrong: 1
    assert np.all(np.abs(got.m) < 0.1)
    assert np.all(np.abs(got.c) < 0.02)


@dataclass(frozen=True)
class Constant(Estimator):
    """Finds the same whatever it sees, and counts what it was expanded about, in the frame of the sky."""

    value: tuple[float, float]
    counted: dict[complex, int] = field(default_factory=dict)

    name = "constant"
    is_expanded = True

    def terms(self, sample, about):
        for g in np.conj(about).tolist():
            self.counted[g] = self.counted.get(g, 0) + 1
        value = np.broadcast_to(self.value, (len(sample), 2))
        return Terms(np.array(value), np.broadcast_to(np.eye(2), (len(sample), 2, 2)))


def test_a_first_guess_of_few_galaxies_is_kept_within_reach(experiment):
    """Without that a shear of 2 was expanded about, where there is none."""
    wild = Constant((2.0, -1.0))
    estimate_isolated_bias(replace(experiment, has_rings=False), wild, 100)
    assert max(abs(about) for about in wild.counted) == pytest.approx(0.3)


def test_a_narrow_cut_leaves_enough_galaxies_for_a_first_guess(experiment):
    counting = Constant((0.01, 0.0))
    narrow = replace(experiment, flux_min=150e-6, has_rings=False)
    estimate_isolated_bias(narrow, counting, 5000)
    # behind both shears, with both signs of the noise
    assert counting.counted[0j] / 4 > 80


@pytest.mark.long
def test_the_papers_shear_moves_no_sizes_and_shows_it(bright, moments):
    """A lens that leaves alpha is none: the response of moments to it is less by a tenth or so."""
    legacy = replace(bright, lens=shear_at_fixed_scale_length)
    true = estimate_isolated_bias(bright, moments, 100)
    wrong = estimate_isolated_bias(legacy, moments, 100)
    assert np.all(np.abs(true.m) < 3e-3)
    assert np.all(wrong.m < -0.03)


def test_the_mean_of_faint_galaxies_is_biased_by_noise(beam, moments):
    """And moments of the same galaxies with the same noise are not; the mean loses a third of the shear."""
    population = Population(flux=PowerLawFlux(minimum=10e-6, maximum=15e-6))
    faint = Experiment(beam, SHEARS, population=population, seed=5)
    assert _bias(faint, Mean(), NONE, 30).m.mean() < -0.15
    assert np.all(np.abs(_bias(faint, moments, SHEARS, 30).m) < 5e-3)


def test_metacal_of_moments_is_what_their_analytic_response_says(experiment, moments):
    """Of the same galaxies and noise, by differences of sheared data."""
    total = estimate_isolated_bias(replace(experiment, has_rings=False), Metacal(moments), 100)
    # both signs of all noise; the third order is 0.002
    assert np.all(total.m_err < 0.015)
    assert np.all(np.abs(total.m) < 8e-3)


@dataclass(frozen=True)
class Wrong(Estimator):
    """Moments that take themselves for a third more responsive than they are."""

    moments: Moments

    name = "wrong"
    columns = Moments.columns
    shape_columns = Moments.shape_columns
    is_expanded = True

    def statistic(self, source):
        return self.moments.statistic(source)

    def terms(self, sample, about):
        own = self.moments.terms(sample, np.zeros(len(sample), complex))
        shear = np.stack([about.real, about.imag], axis=-1)
        value = own.value - 1.3 * np.einsum("sij,sj->si", own.response, shear)
        return Terms(value, 1.3 * own.response)


def test_metacal_finds_the_response_that_an_estimator_has_wrong(experiment, moments):
    strong = replace(experiment, has_rings=False)
    wrong = Wrong(moments)
    biased, mended = (
        estimate_isolated_bias(strong, method, 100) for method in (wrong, Metacal(wrong))
    )
    # -0.3/1.3, and a third order
    assert np.all(biased.m < -0.2)
    assert np.all(np.abs(mended.m) < 8e-3)


def test_metacal_of_the_mean_of_bright_galaxies_finds_the_shear(bright):
    """A response of a wrong sign, or off by a fifth, is seen; the noise bias of faint ones takes thousands of them."""
    strong = replace(bright, shears=(0.1 + 0j, -0.1 + 0j), has_rings=False)
    assert abs(_bias(strong, Metacal(), NONE, 30).m[0]) < 0.15


def test_galaxies_are_drawn_by_their_numbers(experiment, moments):
    first = sum_terms(experiment, moments, SHEARS, 50, 10)
    again = sum_terms(experiment, moments, SHEARS, 50, 10)
    other = sum_terms(experiment, moments, SHEARS, 100, 10)
    assert np.array_equal(first.values, again.values)
    assert not np.array_equal(first.values, other.values)


def test_shears_are_those_of_the_sky(bright, moments):
    """A galaxy behind g1 + i g2 has an ellipticity of the conjugate in the frame of (l, m): East is to the left."""
    along = replace(bright, shears=(0.05j, -0.05j))
    rows: list[list[float]] = [[], []]
    for mock in mock_galaxies(along, 0, 8):
        rows[mock.shear].append(moments.statistic(mock.source)["m2"])
    # the difference of the two is free of shapes and noise; moments in the uv plane have the opposite sign of e
    assert np.mean(rows[0]) > np.mean(rows[1]) + 1e-6
    # measured 0.003; of the other sign m would be -2
    assert abs(_bias(along, moments, along.shears, 8).m[1]) < 0.02


def test_a_cut_on_the_catalogues_flux_leaves_out_the_faint(experiment, moments):
    every = sum_terms(experiment, moments, SHEARS, 0, 50).count.sum()
    some = sum_terms(replace(experiment, snr_min=20.0), moments, SHEARS, 0, 50).count.sum()
    assert 0 < some < every == 50


def test_shears_that_do_not_cancel_are_refused(beam):
    with pytest.raises(InputError, match="add up to zero"):
        Experiment(beam, (0.02 + 0j, 0.02j))


def test_without_shear_only_the_additive_bias_is_told(beam, moments):
    total = estimate_isolated_bias(Experiment(beam, (0j,), seed=3), moments, 100)
    record = total.record()
    assert "m1" not in record
    assert abs(record["c1"]) < 1e-4


def test_the_beams_ellipticity_leaks_into_the_mean_and_not_into_moments():
    """Sixty degrees from zenith, faint galaxies without a shear."""
    beam = Survey(plan(29.3)).isolated((0j,)).beam
    population = Population(flux=PowerLawFlux(minimum=10e-6, maximum=15e-6))
    faint = Experiment(beam, (0j,), population=population, seed=5)
    assert _bias(faint, Mean(), (0j,), 25).c[0] < -0.004
    assert abs(_bias(faint, Moments(), (0j,), 25).c[0]) < 2e-4


def test_galaxies_below_a_flux_are_left_out(experiment, moments):
    every = sum_terms(experiment, moments, SHEARS, 0, 50).count
    some = sum_terms(replace(experiment, flux_min=50e-6), moments, SHEARS, 0, 50).count
    np.testing.assert_array_equal(some[:3], [0, 0, every[2]])


def test_fluxes_of_no_bin_are_in_the_total_alone(experiment, moments):
    flux = PowerLawFlux(minimum=300e-6, maximum=400e-6)
    beyond = replace(experiment, population=Population(flux=flux))
    total = estimate_isolated_bias(beyond, moments, 100)
    assert total.n == 100
    assert not total.bins


def test_a_cut_on_what_was_measured_takes_galaxies_out_one_measurement_at_a_time(
    experiment, moments
):
    def sums(snr_min):
        return sum_terms(replace(experiment, measured_snr_min=snr_min), moments, SHEARS, 0, 12)

    everyone = sums(0.0).values
    np.testing.assert_array_equal(sums(1e-6).values, everyone)
    nobody = sums(1e6)
    assert not nobody.values.any()
    assert not nobody.failed.any()
    some = sums(20.0).values
    assert 0 < some[:, :, 2].sum() / everyone[:, :, 2].sum() < 1


def test_without_rings_each_galaxy_is_seen_twice_behind_a_shear(experiment):
    assert len(experiment.realisations) == 4
    assert len(replace(experiment, has_rings=False).realisations) == 2
    assert replace(experiment, shears=(0j,)).realisations is TURNED


@dataclass(frozen=True)
class Failing(Constant):
    """Measures nothing of galaxies of 20 uJy and more, and tells nothing of those from 15 uJy on."""

    name = "failing"
    is_expanded = False
    shape_columns = ("flux",)

    def statistic(self, source):
        return None if source.flux > 20e-6 else {}

    def terms(self, sample, about):
        terms = super().terms(sample, about)
        return terms.weighted((sample["flux"] < 15e-6).astype(float))


def test_failures_are_counted_apart_from_galaxies_that_tell_nothing(experiment):
    sums = sum_terms(experiment, Failing((0.1, 0.0)), NONE, 0, 50)
    everyone = sum_terms(experiment, Constant((0.1, 0.0)), NONE, 0, 50)
    # four realisations behind two shears
    np.testing.assert_array_equal(sums.failed, [0, *(8 * everyone.count[1:])])
    assert 0 < sums.count[0] < everyone.count[0]
    assert not sums.count[1:].any()


@dataclass(frozen=True)
class Pupil(Constant):
    """Learns how many galaxies it was shown, and about which shear."""

    taught: tuple[int, complex] | None = None

    name = "pupil"
    is_expanded = False

    @property
    def is_learning(self):
        return self.taught is None

    def trained(self, sample, about, meter=None):
        return Pupil((0.1, 0.0), self.counted, (len(sample), about))

    def terms(self, sample, about):
        self.counted[complex(self.taught[0], abs(self.taught[1]))] = 1
        return super().terms(sample, about)


def test_an_estimator_learns_from_other_galaxies_without_a_shear(experiment, monkeypatch):
    monkeypatch.setattr(isolated, "TRAINING", 7)
    pupil = Pupil((0.1, 0.0))
    estimate_isolated_bias(replace(experiment, has_rings=False), pupil, 100)
    assert complex(7, 0.0) in pupil.counted


def test_some_realisations_are_those_of_all(experiment, moments):
    """The noise that is drawn for a galaxy does not depend on how often it is seen."""
    first = mock_galaxies(experiment, 0, 3, experiment.realisations[1:2])
    every = list(mock_galaxies(experiment, 0, 3))[1::4]
    for mock, same in zip(first, every, strict=True):
        assert (mock.number, mock.shear) == (same.number, same.shear)
        np.testing.assert_array_equal(mock.source.facet.correlation, same.source.facet.correlation)
