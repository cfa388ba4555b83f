from dataclasses import FrozenInstanceError

import pytest

from uvshear.imaging.grid import ImageGrid


def test_an_image_is_centred_on_the_phase_centre_unless_told_otherwise():
    assert (ImageGrid(64, 1e-5).l0, ImageGrid(64, 1e-5).m0) == (0.0, 0.0)
    assert ImageGrid(64, 1e-5, 0.1, -0.2) == ImageGrid(64, 1e-5, l0=0.1, m0=-0.2)


def test_it_is_immutable_and_can_be_a_key():
    with pytest.raises(FrozenInstanceError):
        ImageGrid(64, 1e-5).size = 32
    assert len({ImageGrid(64, 1e-5), ImageGrid(64, 1e-5), ImageGrid(32, 1e-5)}) == 2
