from pathlib import Path

import pytest
from matplotlib.figure import Figure

from tests.plot.pictures import check_picture
from uvshear.plot.curves import Curve, CurvePanel, draw_curves


def _figure() -> Figure:
    ours = Curve("ours", [1.0, 10.0], [0.9, 1.0], [0.1, 0.1])
    more = Curve("more", [1.0, 10.0], [0.8, 0.9])
    paper = Curve("the paper", [1.0], [0.95], [0.01], is_published=True, is_line=False)
    panels = [
        CurvePanel("flux", "slope", (ours, more, paper), "first", levels=(1.0,), is_log=True),
        CurvePanel("flux", "slope", (ours,), "second"),
    ]
    return draw_curves(panels)


def test_it_is_a_picture(tmp_path: Path) -> None:
    check_picture(_figure(), tmp_path)


def test_curves_differ_in_colour_and_marker_and_the_paper_is_a_cross() -> None:
    first, second = _figure().axes
    assert first.get_xscale() == "log"
    assert second.get_xscale() == "linear"
    lines = {bars.get_label(): bars.lines[0] for bars in first.containers}
    assert lines["ours"].get_color() != lines["more"].get_color()
    assert lines["ours"].get_marker() != lines["more"].get_marker()
    assert lines["the paper"].get_marker() == "x"
    assert lines["the paper"].get_linestyle() == "None"


def test_points_of_several_curves_are_beside_one_another() -> None:
    linear, logarithmic = draw_curves(
        [
            CurvePanel(
                "x", "y", tuple(Curve(k, [1.0, 10.0], [1.0, 2.0]) for k in "abc"), is_log=log
            )
            for log in (False, True)
        ]
    ).axes
    for ax in (linear, logarithmic):
        places = [bars.lines[0].get_xdata() for bars in ax.containers]
        assert places[0][0] < places[1][0] == 1.0 < places[2][0] < 1.3
        assert places[1][1] == 10.0


def test_what_has_errors_along_both_axes_is_not_moved() -> None:
    curves = tuple(Curve(k, [1.0, 2.0], [1.0, 2.0], [0.1, 0.1], [0.1, 0.1]) for k in "ab")
    (ax,) = draw_curves([CurvePanel("x", "y", curves, is_square=True)]).axes
    assert all(list(bars.lines[0].get_xdata()) == [1.0, 2.0] for bars in ax.containers)
    assert ax.get_aspect() == 1.0


def test_places_have_names() -> None:
    curve = Curve("slopes", [0.0, 1.0], [0.9, 0.95])
    (ax,) = draw_curves([CurvePanel("component", "slope", (curve,), names=("$e_1$", "$e_2$"))]).axes
    assert [label.get_text() for label in ax.get_xticklabels()] == ["$e_1$", "$e_2$"]


@pytest.mark.parametrize("is_log", [False, True])
def test_curves_may_have_no_points(is_log: bool) -> None:
    curves = tuple(Curve(name, [], []) for name in "ab")
    (ax,) = draw_curves([CurvePanel("x", "y", curves, is_log=is_log)]).axes
    assert len(ax.containers) == 2


def test_rows_have_the_same_number_of_panels() -> None:
    curve = (Curve("points", [0.0, 1.0], [0.9, 0.95]),)
    panels = [CurvePanel("x", f"y{number}", curve) for number in range(4)]
    figure = draw_curves(panels, rows=2)
    assert [ax.get_ylabel() for ax in figure.axes] == ["y0", "y1", "y2", "y3"]
    left = [ax.get_position().x0 for ax in figure.axes]
    assert left[0] == left[2] < left[1] == left[3]


def test_panels_may_have_a_common_range() -> None:
    panels = [CurvePanel("x", "y", (Curve("", [0.0, 1.0], y),)) for y in ([0.0, 1.0], [-3.0, 0.5])]
    apart, common = (draw_curves(panels, has_common_y=choice) for choice in (False, True))
    assert apart.axes[0].get_ylim() != apart.axes[1].get_ylim()
    low, high = common.axes[0].get_ylim()
    assert (low, high) == common.axes[1].get_ylim()
    assert low < -3.0
    assert high > 1.0


def test_ticks_may_be_given() -> None:
    curve = Curve("sizes", [0.6, 2.5], [0.0, 1.0])
    (ax,) = draw_curves([CurvePanel("x", "y", (curve,), is_log=True, ticks=(0.6, 2.5))]).axes
    assert [label.get_text() for label in ax.get_xticklabels()] == ["0.6", "2.5"]


def test_seven_curves_can_be_told_apart() -> None:
    curves = tuple(Curve(name, [0.0], [1.0]) for name in "abcdefg")
    (ax,) = draw_curves([CurvePanel("x", "y", curves)]).axes
    looks = {(bars.lines[0].get_color(), bars.lines[0].get_marker()) for bars in ax.containers}
    assert len(looks) == 7
