from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from tests.plot.pictures import check_east_is_left, check_picture
from uvshear.plot.uv_coverage import MOST_POINTS, draw_uv_coverage


def _figure(rows: int = 500) -> Figure:
    rng = np.random.default_rng(1)
    return draw_uv_coverage(rng.normal(0, 1e4, (rows, 3)), np.array([1e9, 1.1e9]))


def test_it_is_a_picture_with_east_to_the_left(tmp_path: Path) -> None:
    check_picture(_figure(), tmp_path)
    check_east_is_left(_figure())


def test_every_baseline_is_drawn_with_its_conjugate() -> None:
    points = _figure().axes[0].collections[0].get_offsets()
    assert points.shape == (1000, 2)
    np.testing.assert_array_equal(points[:500], -points[500:])


def test_of_many_baselines_a_sample_is_drawn() -> None:
    points = _figure(MOST_POINTS + 1000).axes[0].collections[0].get_offsets()
    assert len(points) == 2 * MOST_POINTS
