from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from matplotlib.figure import Figure

from uvshear import plot
from uvshear.constants import ARCSEC
from uvshear.diagnostics.residual_image import DirtyAndResidual
from uvshear.diagnostics.slope import Slope
from uvshear.errors import InputError
from uvshear.imaging import ImageGrid
from uvshear.interferometer.layout import load_layout
from uvshear.interferometer.uv_range import UvRange


def _uv() -> Figure:
    rng = np.random.default_rng(1)
    return plot.draw_uv_coverage(rng.normal(0, 1e4, (500, 3)), np.array([1e9, 1.1e9]))


def _psf() -> Figure:
    offset = np.arange(-16, 16)
    image = np.exp(-(offset[:, None] ** 2 + 2.0 * offset[None, :] ** 2) / 50)
    return plot.draw_psf(image, 0.2 * ARCSEC, 0.1 - 0.02j)


def _shapes() -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    rng = np.random.default_rng(2)
    true = rng.normal(0, 0.2, 50) + 1j * rng.normal(0, 0.2, 50)
    error = rng.uniform(0.02, 0.1, (50, 2))
    measured = true + rng.normal(0, 1, 50) * error[:, 0] + 1j * rng.normal(0, 1, 50) * error[:, 1]
    measured[3] = np.nan  # a flagged galaxy
    return true, measured, error, rng.uniform(1e-5, 1e-4, 50)


def _ellipticities() -> Figure:
    true, measured, error, _ = _shapes()
    return plot.draw_ellipticities(true, measured, error, [Slope(0.98, 0.02), Slope(1.0, 0.03)])


def _residuals() -> Figure:
    return plot.draw_residuals(*_shapes())


def _shear() -> Figure:
    return plot.draw_shear(["mean"], [0.01 + 0.02j], [0.01 + 0.01j], 0.02 + 0j)


def _layout() -> Figure:
    layout = load_layout("vla-a")
    return plot.draw_layout(layout.positions, layout.name)


def _residual_image() -> Figure:
    rng = np.random.default_rng(4)
    residual = rng.normal(0, 1e-6, (64, 64)).astype(np.float32)
    dirty = residual.copy()
    dirty[40, 50] += 1e-4
    grid, used = ImageGrid(64, ARCSEC), UvRange(0.0, 1e5)
    return plot.draw_residual_image(DirtyAndResidual(dirty, residual, grid, 1e12, 1.4e9, used, 999))


FIGURES = [_uv, _psf, _ellipticities, _residuals, _shear, _layout, _residual_image]


@pytest.mark.parametrize("draw", FIGURES)
def test_every_axis_is_labelled_and_every_figure_titled(draw: Callable[[], Figure]) -> None:
    figure = draw()
    panels = [ax for ax in figure.axes if ax.get_label() != "<colorbar>"]
    assert panels
    for ax in panels:
        assert ax.get_xlabel()
        assert ax.get_ylabel()
    suptitle = figure.get_suptitle()
    assert suptitle or all(ax.get_title() for ax in panels)


@pytest.mark.parametrize("draw", FIGURES)
def test_a_figure_becomes_a_picture(draw: Callable[[], Figure], tmp_path: Path) -> None:
    path = tmp_path / "picture.png"
    plot.save(draw(), path)
    assert path.read_bytes().startswith(b"\x89PNG")
    assert [p.name for p in tmp_path.iterdir()] == ["picture.png"]


def test_a_picture_is_not_overwritten_unasked(tmp_path: Path) -> None:
    path = tmp_path / "picture.png"
    path.write_text("kept")
    with pytest.raises(InputError, match="exists already"):
        plot.save(_shear(), path)
    assert path.read_text() == "kept"


def test_an_unknown_kind_of_picture_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"picture\.docx"):
        plot.save(_shear(), tmp_path / "picture.docx")
    assert list(tmp_path.iterdir()) == []


def test_the_slopes_are_quoted() -> None:
    labels = [text.get_text() for ax in _ellipticities().axes for text in ax.get_legend().texts]
    assert "slope 0.980 $\\pm$ 0.020" in labels


def test_east_is_left_in_the_uv_plane_and_in_images() -> None:
    for figure in (_uv(), _psf(), _residual_image()):
        left, right = figure.axes[0].get_xlim()
        assert left > right


def test_the_map_of_the_vla_has_arms_of_twenty_kilometres() -> None:
    whole = _layout().axes[0]
    points = whole.lines[0].get_xydata()
    assert points.shape == (27, 2)
    assert 15 < np.hypot(*points.T).max() < 25  # km
    assert np.argmax(points[:, 1]) == np.argmax(np.hypot(*points.T)) or points[:, 1].max() > 10


def test_dirty_and_residual_image_share_their_colours_and_quote_rms_and_noise() -> None:
    figure = _residual_image()
    dirty, residual = (ax.images[0] for ax in figure.axes[:2])
    assert dirty.norm is residual.norm
    assert dirty.norm.vmax == pytest.approx(100, rel=0.05)  # uJy
    assert "rms 1.0" in figure.axes[1].get_title() or "rms 0.9" in figure.axes[1].get_title()
    assert "thermal noise 1 $\\mu$Jy/beam" in figure.get_suptitle()


def test_a_source_to_the_north_east_is_drawn_there() -> None:
    shown = _residual_image().axes[0].images[0]
    row, column = np.unravel_index(np.argmax(shown.get_array()), (64, 64))
    assert (row, column) == (50, 40)  # m upwards; l along the axis that is inverted
    np.testing.assert_allclose(shown.get_extent(), np.array([-32.5, 31.5] * 2) / 60)
