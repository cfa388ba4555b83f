import numpy as np

from uvshear.diagnostics.coverage_sample import CoverageAccumulator, sample_coverage
from uvshear.geometry.directions import PhaseCentre
from uvshear.interferometer.visibilities import Visibilities, VisibilitySet


def _observation(rows: int = 40) -> VisibilitySet:
    rng = np.random.default_rng(5)
    uvw = rng.normal(0, 3e3, (rows, 3))
    frequency = np.array([1.0e9, 1.2e9])
    weights = rng.uniform(0.5, 2, (rows, 2))
    weights[3] = 0
    noise = rng.normal(size=(rows, 2)) + 1j * rng.normal(size=(rows, 2))
    halves = (slice(0, rows // 3), slice(rows // 3, rows))
    return VisibilitySet(
        PhaseCentre(0.0, 0.0),
        tuple(Visibilities(uvw[h], frequency, noise[h], weights[h]) for h in halves),
    )


def test_the_coverage_has_every_row_with_weight() -> None:
    coverage = sample_coverage(_observation())
    assert coverage.rows == len(coverage.uvw) == 39
    assert coverage.frequency.tolist() == [1.0e9, 1.2e9]


def test_a_large_coverage_is_thinned_evenly() -> None:
    coverage = sample_coverage(_observation(6000), most=1000)
    assert coverage.rows == 5999
    assert 900 < len(coverage.uvw) < 1100
    whole = sample_coverage(_observation(6000)).uvw
    assert abs(coverage.uvw.std() / whole.std() - 1) < 0.1


def test_a_pass_in_two_parts_is_thinned_as_a_whole() -> None:
    observation = _observation(6000)
    first, later = CoverageAccumulator(1000), CoverageAccumulator(1000)
    first.add(observation.blocks[0])
    later.add(observation.blocks[1])
    first.merge(later)
    coverage = first.result()
    assert coverage.rows == 5999
    assert 900 < len(coverage.uvw) < 1100
    in_first_third = np.isin(coverage.uvw[:, 0], observation.blocks[0].uvw[:, 0]).mean()
    assert abs(in_first_third - 1 / 3) < 0.06
