from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from tests.plot.pictures import check_east_is_left, check_picture
from uvshear.constants import ARCSEC
from uvshear.plot.psf import draw_psf


def _figure() -> Figure:
    offset = np.arange(-16, 16)
    image = np.exp(-(offset[:, None] ** 2 + 2.0 * offset[None, :] ** 2) / 50)
    return draw_psf(image, 0.2 * ARCSEC, 0.1 - 0.02j)


def test_it_is_a_picture_with_east_to_the_left(tmp_path: Path) -> None:
    check_picture(_figure(), tmp_path)
    check_east_is_left(_figure())


def test_the_ellipticity_is_quoted() -> None:
    assert "+0.1000 -0.0200i" in _figure().axes[0].get_title()


def test_the_profile_along_l_is_the_wider_one() -> None:
    along_l, along_m = (line.get_ydata() for line in _figure().axes[1].lines[:2])
    assert along_l.sum() > 1.3 * along_m.sum()
