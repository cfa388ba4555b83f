from pathlib import Path

from tests.plot.pictures import check_picture, shapes
from uvshear.plot.residuals import draw_residuals


def test_it_is_a_picture(tmp_path: Path) -> None:
    check_picture(draw_residuals(*shapes()), tmp_path)


def test_the_widths_of_both_components_are_quoted_without_the_flagged_galaxy() -> None:
    figure = draw_residuals(*shapes())
    labels = [text.get_text() for text in figure.axes[0].get_legend().texts]
    widths = [float(label.split()[-1]) for label in labels if "width" in label]
    assert len(widths) == 2
    assert all(0.7 < width < 1.3 for width in widths)
    assert len(figure.axes[1].lines[0].get_xdata()) == 49
