from pathlib import Path

from matplotlib.figure import Figure

from tests.plot.pictures import check_picture
from uvshear.plot.shear import draw_shear


def _figure() -> Figure:
    return draw_shear(["mean"], [0.01 + 0.02j], [0.01 + 0.01j], 0.02 + 0j)


def test_it_is_a_picture(tmp_path: Path) -> None:
    check_picture(_figure(), tmp_path)


def test_estimate_and_truth_are_quoted_and_within_the_axes() -> None:
    (ax,) = _figure().axes
    labels = [text.get_text() for text in ax.get_legend().texts]
    assert any(label.startswith("mean: (+0.0100, +0.0200)") for label in labels)
    assert any(label.startswith("true: (+0.0200, +0.0000)") for label in labels)
    assert ax.get_xlim()[0] < -0.02
    assert ax.get_ylim()[1] > 0.03
