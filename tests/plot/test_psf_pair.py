from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from tests.plot.pictures import check_east_is_left, check_picture
from uvshear.constants import ARCSEC
from uvshear.plot.psf_pair import draw_psf_pair


def _figure() -> Figure:
    offset = np.arange(64) - 32
    image = np.exp(-(offset[:, None] ** 2 + offset[None, :] ** 2) / 20.0)
    return draw_psf_pair({"natural": image, "uniform": image**4 - 0.01}, 0.5 * ARCSEC)


def test_it_is_a_picture(tmp_path: Path) -> None:
    figure = _figure()
    figure.suptitle("both")
    check_picture(figure, tmp_path)


def test_east_is_left_and_both_have_one_scale(tmp_path: Path) -> None:
    figure = _figure()
    check_east_is_left(figure)
    images = [ax.images[0] for ax in figure.axes if ax.images]
    assert images[0].get_clim() == images[1].get_clim()
