import numpy as np
import pytest

from tests.reproduce.small_targets import check_finding, finding_of
from tests.reproduce.surveys import sample_of
from uvshear.constants import MICROJANSKY
from uvshear.reproduce.facet_residuals import TOO_SMALL, _residuals, slopes_with_bad_ones


def test_slopes_and_bad_measurements_are_beside_those_of_the_paper():
    finding = finding_of("facet-residuals")
    check_finding(finding, panels=2)
    values = {row.name: row.paper.value for row in finding.quantities}
    assert values["slope of e1, facets of 600² cells"] == 0.9306
    assert values["slope of e2, facets of Table 1"] == 0.9426
    assert values["bad measurements of 1000, facets of Table 1"] == 25
    failed = [row.as_paper.value for row in finding.quantities if row.name.startswith("bad")]
    assert finding.remarks[1].startswith("Flags with " if any(failed) else "No fit failed.")


def test_residuals_are_means_in_bins_of_the_true_ellipticity():
    true = np.array([0.05, 0.15, 0.12, -0.5])
    measured = true + np.array([0.0, 0.02, 0.04, 0.1])
    curve = _residuals(sample_of(measured, true), "residuals")
    assert curve.x == pytest.approx([(0.05 + 0.15 + 0.12) / 3])
    assert curve.y == pytest.approx([0.02])


def test_bad_measurements_take_weight_from_the_slope():
    """Without noise: half of the galaxies is faint and has a tenth of the weight of the others."""
    rng = np.random.default_rng(3)
    n = 4000
    true = rng.uniform(-0.5, 0.5, n) + 1j * rng.uniform(-0.5, 0.5, n)
    is_faint = np.arange(n) < n // 2
    flux = np.where(is_faint, 15, 100) * MICROJANSKY
    error = np.where(is_faint, 0.1 * 10**0.5, 0.1)[:, None] * np.ones(2)
    sample = sample_of(0.95 * true, true, flux=flux, error=error)
    for slope in slopes_with_bad_ones(sample, 0, rng):
        assert slope.value == pytest.approx(0.95)
    number = 400
    weight = number * TOO_SMALL**2 / 10
    others = n // 2 + (n // 2 - number) / 10
    for slope in slopes_with_bad_ones(sample, number, rng):
        assert slope.value == pytest.approx(0.95 * others / (others + weight), rel=0.01)
        assert 0 < slope.error < 0.02
