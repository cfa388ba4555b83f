import numpy as np

from tests.reproduce.surveys import small_survey
from uvshear.constants import ARCSEC
from uvshear.interferometer.weighting import RoundPsf
from uvshear.reproduce.cell_counts import FixedCount
from uvshear.reproduce.facet_ways import (
    CellFacets,
    ExactFacetWay,
    RoundCoverage,
    RoundNoise,
    smallest_scale_length,
)


def test_both_ways_have_the_same_total_weight_near_the_origin():
    """A large galaxy sees only short baselines, whose weights are the same in cells and in images."""
    samples = small_survey().samples()
    exact = ExactFacetWay().beam(samples, ARCSEC)
    cells = CellFacets(FixedCount(600)).beam(samples, ARCSEC)
    log_median = float(np.log(2 * ARCSEC))
    powers = [beam.simulator(log_median, 0.3).power.sum() for beam in (exact, cells)]
    assert powers[0] == np.float64(powers[1]).item() or abs(powers[0] / powers[1] - 1) < 0.05


def test_samples_are_in_the_order_of_their_baselines():
    beam = CellFacets(FixedCount(100)).beam(small_survey().samples(), ARCSEC)
    assert np.all(np.diff(np.hypot(*beam.uv.T)) >= 0)


def test_cells_extend_to_the_longest_baseline_that_is_used():
    samples = small_survey().samples()
    whole, part = (
        CellFacets(FixedCount(100), longest).beam(samples, ARCSEC) for longest in (1.0, 0.5)
    )
    reach = [float(np.hypot(*beam.uv[-1])) for beam in (whole, part)]
    assert 0.45 < reach[1] / reach[0] <= 0.5
    simulators = [beam.simulator(float(np.log(ARCSEC)), 0.3) for beam in (whole, part)]
    assert simulators[1].cell == simulators[0].cell * reach[1] / reach[0]


def test_the_smallest_galaxies_are_two_deviations_below_the_median():
    assert smallest_scale_length(0.0, 0.5) == np.exp(-1.0)


def test_round_noise_changes_the_noise_alone():
    samples = small_survey(weightings=(RoundPsf(),)).samples()
    log_median = float(np.log(2 * ARCSEC))
    real, experiment = (
        way.beam(samples, ARCSEC).simulator(log_median, 0.3)
        for way in (ExactFacetWay(), RoundNoise())
    )
    np.testing.assert_array_equal(experiment.power, real.power)
    assert np.abs(real.noise_power - real.power).max() > 0.01 * real.power.max()
    assert not hasattr(experiment, "noise_power")  # its noise has the variance of its power


def test_a_round_coverage_has_the_same_power_in_every_direction():
    samples = small_survey().samples()
    log_median = float(np.log(2 * ARCSEC))
    real, experiment = (
        way.beam(samples, ARCSEC).simulator(log_median, 0.3)
        for way in (ExactFacetWay(), RoundCoverage())
    )
    u, v = real.uv.T
    near = np.hypot(u, v) < 2e4
    elongation = [
        abs(np.sum(beam.power[near] * ((u + 1j * v) ** 2)[near]))
        / np.sum(beam.power[near] * (u**2 + v**2)[near])
        for beam in (real, experiment)
    ]
    assert elongation[0] > 0.03
    assert elongation[1] < 0.2 * elongation[0]
