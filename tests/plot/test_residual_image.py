from pathlib import Path

import numpy as np
import pytest
from matplotlib.figure import Figure

from tests.plot.pictures import check_east_is_left, check_picture
from uvshear.constants import ARCSEC
from uvshear.diagnostics.residual_image import DirtyAndResidual
from uvshear.imaging import ImageGrid
from uvshear.interferometer.uv_range import UvRange
from uvshear.plot.residual_image import draw_residual_image


def _figure() -> Figure:
    rng = np.random.default_rng(4)
    residual = rng.normal(0, 1e-6, (64, 64)).astype(np.float32)
    dirty = residual.copy()
    dirty[40, 50] += 1e-4
    grid, used = ImageGrid(64, ARCSEC), UvRange(0.0, 1e5)
    return draw_residual_image(DirtyAndResidual(dirty, residual, grid, 1e12, 1.4e9, used, 999))


def test_it_is_a_picture_with_east_to_the_left(tmp_path: Path) -> None:
    check_picture(_figure(), tmp_path)
    check_east_is_left(_figure())


def test_dirty_and_residual_image_share_their_colours_and_quote_rms_and_noise() -> None:
    figure = _figure()
    dirty, residual = (ax.images[0] for ax in figure.axes[:2])
    assert dirty.norm is residual.norm
    assert dirty.norm.vmax == pytest.approx(100, rel=0.05)  # uJy
    assert "rms 1.0" in figure.axes[1].get_title() or "rms 0.9" in figure.axes[1].get_title()
    assert "thermal noise 1 $\\mu$Jy/beam" in figure.get_suptitle()


def test_a_source_to_the_north_east_is_drawn_there() -> None:
    shown = _figure().axes[0].images[0]
    row, column = np.unravel_index(np.argmax(shown.get_array()), (64, 64))
    assert (row, column) == (50, 40)  # m upwards; l along the axis that is inverted
    np.testing.assert_allclose(shown.get_extent(), np.array([-32.5, 31.5] * 2) / 60)
