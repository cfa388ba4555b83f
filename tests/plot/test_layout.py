from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from tests.plot.pictures import check_picture
from uvshear.interferometer.layout import load_layout
from uvshear.plot.layout import draw_layout


def _figure() -> Figure:
    layout = load_layout("vla-a")
    return draw_layout(layout.positions, layout.name)


def test_it_is_a_picture(tmp_path: Path) -> None:
    check_picture(_figure(), tmp_path)


def test_the_map_of_the_vla_has_arms_of_twenty_kilometres() -> None:
    whole = _figure().axes[0]
    points = whole.lines[0].get_xydata()
    assert points.shape == (27, 2)
    assert 15 < np.hypot(*points.T).max() < 25  # km
    assert np.argmax(points[:, 1]) == np.argmax(np.hypot(*points.T)) or points[:, 1].max() > 10
