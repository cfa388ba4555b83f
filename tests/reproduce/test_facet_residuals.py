import numpy as np
import pytest

from tests.reproduce.small_targets import check_finding, finding_of
from tests.reproduce.surveys import sample_of
from uvshear.reproduce.facet_residuals import _residuals


def test_slopes_and_bad_measurements_are_beside_those_of_the_paper():
    finding = finding_of("facet-residuals")
    check_finding(finding, panels=2)
    values = {row.name: row.paper.value for row in finding.quantities}
    assert values["slope of e1, facets of 600² cells"] == 0.9306
    assert values["slope of e2, facets of Table 1"] == 0.9426
    assert values["bad measurements of 1000, facets of Table 1"] == 25
    assert any(remark.startswith("Flags with facets of Table 1:") for remark in finding.remarks)


def test_residuals_are_means_in_bins_of_the_true_ellipticity():
    true = np.array([0.05, 0.15, 0.12, -0.5])
    measured = true + np.array([0.0, 0.02, 0.04, 0.1])
    curve = _residuals(sample_of(measured, true), "residuals")
    assert curve.x == pytest.approx([(0.05 + 0.15 + 0.12) / 3])
    assert curve.y == pytest.approx([0.02])
