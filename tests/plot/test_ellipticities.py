from pathlib import Path

from matplotlib.figure import Figure

from tests.plot.pictures import check_picture, shapes
from uvshear.diagnostics.slope import Slope, Slopes
from uvshear.plot.ellipticities import draw_ellipticities

SLOPES = Slopes(
    inverse_variance=Slope(0.98, 0.02, 0.01, 23.4),
    population=Slope(0.88, 0.03, 0.03, 40.0),
    unweighted=Slope(0.81, 0.04, 0.03, 45.0),
)


def _figure() -> Figure:
    true, measured, error, _ = shapes()
    return draw_ellipticities(true, measured, error, [SLOPES, SLOPES])


def test_it_is_a_picture(tmp_path: Path) -> None:
    check_picture(_figure(), tmp_path)


def test_the_slope_of_the_paper_comes_first_with_its_number_of_galaxies() -> None:
    for ax in _figure().axes:
        labels = [text.get_text() for text in ax.get_legend().texts]
        assert labels[0] == "measured = true"
        assert labels[1].startswith("slope 0.980 $\\pm$ 0.020, weights $1/s^2$")
        assert "= 23)" in labels[1]
        assert labels[2] == "0.880 $\\pm$ 0.030, weights $1/(s^2 + 0.07)$"
        assert labels[3] == "0.810 $\\pm$ 0.040, unweighted"


def test_the_line_drawn_is_that_of_the_paper_s_weights() -> None:
    dashed = next(line for line in _figure().axes[0].lines if line.get_linestyle() == "--")
    x, y = dashed.get_xydata().T
    assert y[1] / x[1] == SLOPES.inverse_variance.value


def test_the_figure_says_why_the_other_slopes_are_lower() -> None:
    caption = _figure().get_supxlabel()
    assert "posterior mean with a flat prior" in caption
    assert "Rivi & Miller 2018" in caption
