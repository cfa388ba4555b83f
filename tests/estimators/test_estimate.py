"""From a sample to the shear: rounds, frames, bins of flux, and work side by side."""

from dataclasses import dataclass, field, replace
from itertools import pairwise

import numpy as np
import pytest

from tests.estimators.test_evidence import Toy
from uvshear.errors import InputError
from uvshear.estimators.bayesian import Bayesian
from uvshear.estimators.estimate import PART, estimate_sample_shear, sky_terms, within_reach
from uvshear.estimators.estimator import Estimator
from uvshear.estimators.mean import Mean
from uvshear.estimators.metacal import Metacal
from uvshear.estimators.moments import Moments
from uvshear.estimators.packing import pack
from uvshear.estimators.sample import Sample
from uvshear.estimators.terms import Terms
from uvshear.execution import SERIAL, Copies, Processes, Serial, Threads
from uvshear.geometry.directions import PhaseCentre, local_north
from uvshear.geometry.ellipticity import to_field_frame
from uvshear.progress import Meter

COUNT = PART + 10


def _numbers(rng, number=COUNT):
    """Statistics of all estimators but the Bayesian, of no galaxy in particular."""
    names = ["e1", "e2", "mc1", "mc2", "mc_r12", "mc_r21", "m1", "m2", "r12", "r_third"]
    columns = {name: 0.2 * rng.normal(size=number) for name in names}
    for name in ("mc_r11", "mc_r22", "r11", "r22", "weight"):
        columns[name] = rng.uniform(1, 2, number)
    for name in ("m1_var", "m2_var"):
        columns[name] = rng.uniform(1e-12, 1e-10, number)
    columns["flux"] = rng.uniform(1e-5, 1e-4, number)
    return columns


def _packed_column(likelihoods, name):
    column = np.empty(len(likelihoods), object)
    for row, likelihood in enumerate(likelihoods):
        column[row] = likelihood[name]
    return column


@pytest.fixture(scope="module")
def sample():
    rng = np.random.default_rng(9)
    columns = _numbers(rng)
    few = [pack(Toy(0.3 * complex(*rng.normal(size=2)) / 2, 0.1).on_lattice()) for _ in range(5)]
    likelihoods = [few[k % 5] for k in range(COUNT)]
    columns |= {name: _packed_column(likelihoods, name) for name in likelihoods[0]}
    return Sample(columns, rng.uniform(-1, 1, COUNT))


def _same(first, second):
    np.testing.assert_array_equal(first.value, second.value)
    np.testing.assert_array_equal(first.response, second.response)


@pytest.mark.parametrize(
    "estimator", [Mean(), Moments(), Metacal(), Bayesian()], ids=lambda e: e.name
)
def test_terms_are_the_same_however_a_sample_is_divided(sample, estimator):
    whole = sky_terms(estimator, sample, 0.02 - 0.01j)
    assert len(whole) == COUNT
    cuts = [0, 1, 20, PART + 1, COUNT]
    parts = [
        sky_terms(estimator, sample.select(slice(first, last)), 0.02 - 0.01j)
        for first, last in pairwise(cuts)
    ]
    _same(Terms.joined(parts), whole)


@pytest.mark.parametrize("executor", [Threads(3), Processes(2), Copies(2)])
def test_terms_are_the_same_bit_by_bit_whatever_the_executor(sample, executor):
    for estimator in (Mean(), Moments(), Metacal(), Bayesian()):
        alone, together = (
            sky_terms(estimator, sample, 0.02 - 0.01j, how) for how in (SERIAL, executor)
        )
        _same(together, alone)


@pytest.mark.parametrize("estimator", [Mean(), Moments(), Metacal()], ids=lambda e: e.name)
def test_the_shear_is_the_same_whatever_the_executor(sample, estimator):
    found = [estimate_sample_shear(estimator, sample, how) for how in (Serial(), Threads(3))]
    assert found[0] == found[1]
    assert found[0].bins


CENTRE = PhaseCentre(1.0, np.radians(80.0))


def _far_from_the_centre(number=40):
    """Directions more than a degree off, where local North turns by up to 15 degrees."""
    rng = np.random.default_rng(4)
    angle = rng.uniform(0, 2 * np.pi, number)
    l, m = 0.035 * np.cos(angle), 0.035 * np.sin(angle)
    north = local_north(CENTRE, l, m)
    assert np.abs(north).max() > 0.19
    return north


@pytest.mark.parametrize("shear", [0.03 + 0j, -0.02 + 0.05j])
def test_a_constant_shear_of_the_sky_is_found_far_from_the_centre_by_the_mean(shear):
    """Each galaxy with e and -e: the mean of both behind a shear is the shear, to the second order in it."""
    north = _far_from_the_centre()
    g = to_field_frame(np.full(40, shear), north)
    # circles: nothing but the shear is left
    sample = Sample({"e1": g.real, "e2": g.imag, "weight": np.linspace(1, 2, 40)}, north)
    found = estimate_sample_shear(Mean(), sample)
    assert found.shear == pytest.approx(shear, abs=1e-14)
    assert found.frame == "sky"


@pytest.mark.parametrize("shear", [0.03 + 0j, -0.02 + 0.05j])
def test_a_constant_shear_of_the_sky_is_found_far_from_the_centre_by_moments(shear):
    north = _far_from_the_centre()
    g = to_field_frame(np.full(40, shear), north)
    # a response of its own to every direction, and a third order
    response = np.linspace(1, 2, 40) * 1e-5
    third = -0.3 * response
    factor = response + (response - 2 * third) * abs(shear) ** 2
    tilt = 0.1 * response
    columns = {
        "m1": factor * g.real + tilt * g.imag,
        "m2": factor * g.imag + tilt * g.real,
        "r11": response,
        "r12": tilt,
        "r22": response,
        "r_third": third,
        "m1_var": np.full(40, 1e-13),
        "m2_var": np.full(40, 1e-13),
        "flux": response,
    }
    found = estimate_sample_shear(Moments(), Sample(columns, north))
    assert found.shear == pytest.approx(shear, abs=1e-3 * abs(shear) ** 3)


@dataclass(frozen=True)
class Linear(Estimator):
    """One number a source, about the shear; records what it was expanded about."""

    reach: float = 1.0
    seen: list[complex] = field(default_factory=list)

    name = "linear"
    is_expanded = True

    def terms(self, sample, about):
        self.seen.append(complex(about[0]))
        g = self.reach * np.conj(sample["g"]) - about
        response = np.broadcast_to(np.eye(2), (len(sample), 2, 2))
        return Terms(np.stack([g.real, g.imag], axis=-1), response)


def test_the_expansion_is_iterated_about_the_estimate():
    estimator = Linear()
    found = estimate_sample_shear(estimator, Sample({"g": np.full(3, 0.1 + 0.2j)}, np.zeros(3)))
    assert found.shear == pytest.approx(0.1 + 0.2j)
    # about is in the frame of (l, m)
    np.testing.assert_allclose(estimator.seen, [0, 0.1 - 0.2j, 0.1 - 0.2j])


def test_a_first_estimate_that_is_wild_is_kept_within_reach():
    estimator = Linear(reach=20.0)
    estimate_sample_shear(estimator, Sample({"g": np.full(3, 0.1 + 0j)}, np.zeros(3)))
    assert max(abs(about) for about in estimator.seen) == pytest.approx(0.3)
    assert within_reach(0j) == 0
    assert within_reach(0.1j) == 0.1j
    assert within_reach(-3.0 + 0j) == pytest.approx(-0.3)


def _by_flux(number, value=0.1):
    e = np.full(number, value)
    return {"e1": e, "e2": e, "weight": np.ones(number)}


def test_bins_of_enough_galaxies_have_a_shear_of_their_own():
    flux = np.concatenate([np.full(20, 1.5e-5), np.full(19, 3e-5), np.full(25, 1e-4)])
    sample = Sample({**_by_flux(64), "flux": flux}, np.zeros(64))
    sample["e1"][-25:] = 0.2
    found = estimate_sample_shear(Mean(), sample)
    assert {name: part.n for name, part in found.bins.items()} == {
        "10-20 uJy": 20,
        "50-200 uJy": 25,
    }
    assert found.bins["50-200 uJy"].g1 == pytest.approx(0.2)
    assert found.n == 64


def test_a_bin_has_the_shear_that_its_galaxies_have_alone():
    """Bins are worked on together with the whole sample, each about its own shear."""
    rng = np.random.default_rng(2)
    columns = _numbers(rng, 70)
    columns["flux"] = np.where(np.arange(70) % 3 == 0, 1.5e-5, 3e-5)
    sample = Sample(columns, rng.uniform(-1, 1, 70))
    found = estimate_sample_shear(Moments(), sample)
    for name, flux in (("10-20 uJy", 1.5e-5), ("20-50 uJy", 3e-5)):
        alone = estimate_sample_shear(Moments(), sample.select(columns["flux"] == flux))
        assert found.bins[name] == replace(alone, bins={}, assumed={})


def test_a_bin_of_galaxies_that_tell_nothing_is_left_out():
    flux = np.concatenate([np.full(30, 1.5e-5), np.full(30, 3e-5)])
    columns = {**_by_flux(60), "flux": flux}
    columns["weight"][:30] = 0
    assert list(estimate_sample_shear(Mean(), Sample(columns, np.zeros(60))).bins) == ["20-50 uJy"]


def test_a_sample_without_fluxes_has_no_bins():
    assert estimate_sample_shear(Mean(), Sample(_by_flux(60), np.zeros(60))).bins == {}


def test_too_few_galaxies_are_told():
    columns = _by_flux(5)
    columns["weight"][1:] = 0
    with pytest.raises(InputError, match="of 5 selected galaxies, fewer than 2 contribute"):
        estimate_sample_shear(Mean(), Sample(columns, np.zeros(5)))


@dataclass(frozen=True)
class Pupil(Linear):
    """Learns the factor by which it is wrong from the sample."""

    teaches: bool = True

    @property
    def is_learning(self):
        return self.teaches

    def trained(self, sample, about, meter=None):
        return replace(self, reach=0.1 / abs(about), teaches=False)

    def record(self):
        return {"reach": self.reach}


def test_an_estimator_learns_from_the_whole_sample_before_it_estimates():
    flux = np.concatenate([np.full(30, 1.5e-5), np.full(30, 3e-5)])
    sample = Sample({"g": np.full(60, 0.2 + 0j), "flux": flux}, np.zeros(60))
    found = estimate_sample_shear(Pupil(), sample)
    assert found.assumed == {"reach": pytest.approx(0.5)}
    assert found.g1 == pytest.approx(0.1)
    assert [part.g1 for part in found.bins.values()] == pytest.approx([0.1, 0.1])


def test_the_meter_counts_sources_in_every_round():
    told = []
    sample = Sample({"g": np.full(PART + 2, 0.1 + 0j)}, np.zeros(PART + 2))
    estimate_sample_shear(
        Linear(), sample, SERIAL, Meter(lambda done, total: told.append((done, total)))
    )
    total = 3 * (PART + 2)
    assert told[-1] == (total, total)
    assert [done for done, _ in told[:2]] == [PART, PART + 2]


class Cancelling(Estimator):
    """Responses of both signs, which add up to almost nothing."""

    name = "cancelling"

    def terms(self, sample, about):
        return Terms(sample["value"], sample["response"])


def _cancelling(number, rng):
    sign = np.where(np.arange(number) % 2, 1.0, -1.0) + 1e-3
    return sign[:, None, None] * np.eye(2), rng.normal(size=(number, 2))


def test_an_absurd_error_is_told_and_its_bin_is_left_out():
    rng = np.random.default_rng(3)
    response, value = _cancelling(80, rng)
    # the brighter forty have an ordinary response
    response[40:] = np.eye(2)
    flux = np.where(np.arange(80) < 40, 15e-6, 30e-6)
    columns = {"value": 0.1 * value, "response": response, "flux": flux}
    found = estimate_sample_shear(Cancelling(), Sample(columns, np.zeros(80)))
    assert list(found.bins) == ["20-50 uJy"]
    (remark,) = found.remarks
    assert remark.startswith("the galaxies of 10-20 uJy do not determine a shear")
    assert remark.endswith("this bin is left out")
    faint = {name: values[:40] for name, values in columns.items()}
    worst = estimate_sample_shear(Cancelling(), Sample(faint, np.zeros(40)))
    assert worst.error > 1
    assert worst.remarks[0].startswith(
        "these galaxies do not determine a shear: its standard error"
    )
