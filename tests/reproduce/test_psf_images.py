import math

import numpy as np
import pytest

from tests.plot.pictures import check_picture
from uvshear.constants import ARCSEC
from uvshear.imaging import ImageGrid
from uvshear.reproduce.paper_pointing import PaperPointing
from uvshear.reproduce.psf_images import PsfImages


@pytest.fixture(scope="module")
def target():
    grid = ImageGrid(256, 0.15 * ARCSEC)
    return PsfImages(
        pointing=PaperPointing(integration=3600.0), grid=grid, plateau=(5 * ARCSEC, 15 * ARCSEC)
    )


@pytest.fixture(scope="module")
def found(target):
    return {name: target.measure(task) for name, task in target.tasks().items()}


def test_the_natural_psf_has_a_plateau_and_the_uniform_one_has_none(target, found):
    finding = target.finding(found)
    values = {quantity.name: quantity.own.value for quantity in finding.quantities}
    widths = [value for name, value in values.items() if name.startswith("full width")]
    levels = [value for name, value in values.items() if name.startswith("mean level")]
    assert widths[0] > 5 * widths[1]
    assert levels[0] > 0.2
    assert abs(levels[1]) < 0.01


def test_images_are_one_at_their_centres(found):
    for part in found.values():
        assert part["image"][128, 128] == pytest.approx(1, abs=1e-3)
        assert math.isclose(float(np.max(part["image"])), 1, abs_tol=1e-3)


def test_it_is_a_picture(target, found, tmp_path):
    figure = target.finding(found).picture
    figure.suptitle("title")
    check_picture(figure, tmp_path)


def test_the_full_width_of_a_gaussian_is_its_own(target):
    offset = (np.arange(256) - 128) * 0.15
    squares = offset[:, None] ** 2 + offset[None, :] ** 2
    widths = {"natural": 6.0, "uniform": 2.5}
    images = {name: np.exp(-4 * math.log(2) * squares / width**2) for name, width in widths.items()}
    finding = target.finding({name: {"image": image} for name, image in images.items()})
    found = [row.own.value for row in finding.quantities if row.name.startswith("full width")]
    assert found == pytest.approx(list(widths.values()), rel=0.02)
