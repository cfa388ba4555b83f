"""The beam of the interaction: far couplings, cells for galaxies that overlap, changes in units of the noise."""

import numpy as np
import pytest

from tests.extraction.converged.five_galaxies import (
    CHANGES,
    SKY,
    before_a_vla,
    before_an_array_with_a_core,
)
from tests.reference import plane
from uvshear.constants import ARCSEC
from uvshear.extraction.converged.interaction import END, FAR, START
from uvshear.imaging.bands import Band
from uvshear.predict.rendering import smooth_step


@pytest.fixture(scope="module")
def field():
    return before_a_vla()


@pytest.fixture(scope="module")
def with_core():
    return before_an_array_with_a_core()


def test_far_couplings_are_the_part_of_the_plateau_that_the_image_does_not_hold(with_core):
    far = with_core.interaction().far.toarray()
    np.testing.assert_array_equal(far, far.T)
    np.testing.assert_array_equal(np.diag(far), 0)
    place = np.column_stack([SKY.l, SKY.m])
    pixel = 2 * with_core.plan.pixel
    for i, j in ((0, 1), (0, 2), (0, 3), (1, 4), (3, 4)):
        distance = np.hypot(*(place[j] - place[i]))
        held = float(smooth_step(np.array([distance]), START * pixel, END * pixel)[0])
        plateau = float(with_core.beams.plateau((place[j] - place[i])[None, :])[0])
        expected = plateau * (1 - held) if distance < FAR * END * pixel else 0.0
        assert far[i, j] == pytest.approx(expected, abs=1e-4 * float(with_core.beams.wide.max()))
    assert far[0, 1] == far[0, 2] == 0
    assert far[0, 3] > 0
    assert far[0, 4] > far[0, 3]  # half of it is in the image at 417 arcsec


def test_sources_farther_than_the_plateau_reaches_are_not_coupled(with_core):
    interaction = with_core.interaction()
    assert interaction.reach == pytest.approx(END * 2 * with_core.plan.pixel)
    place = np.column_stack([SKY.l, SKY.m])
    assert np.hypot(*(place[3] - place[4])) < FAR * interaction.reach
    assert interaction.far[3, 4] != 0


@pytest.mark.parametrize("short", [False, True])
def test_the_cells_of_a_beam_give_the_norm_of_a_galaxy(field, short):
    """As the cells of a facet give it, though they are finer and end at half the baselines."""
    interaction = field.interaction()
    cells = interaction.short_plane_around(0) if short else interaction.plane_around(0)
    cutout = field.plan.cutouts[0]
    norms = [
        float(np.sum(power * np.abs(plane.galaxy(uv, 1.0, (0, 0), 0.3 - 0.2j, 6 * ARCSEC)) ** 2))
        for uv, power in ((cells.uv, cells.power), (cutout.uv, field.beams.power(0, cutout)))
    ]
    limit = field.plan.bands[0].longest / (4 if short else 2)
    assert np.hypot(*cells.uv.T).max() <= limit
    assert norms[0] == pytest.approx(norms[1], rel=0.01 if short else 1e-3)  # measured 4e-3, 3e-4


def test_the_interaction_of_a_band_ends_at_half_the_longest_baseline(field):
    assert field.interaction()._band == Band(
        0.0, field.plan.bands[0].longest / 2, 2 * field.plan.pixel
    )


@pytest.mark.parametrize("name", sorted(CHANGES))
def test_a_change_is_told_in_units_of_the_noise(field, name):
    sky = CHANGES[name]
    told, _ = field.rendered(0, SKY, sky)
    assert told == pytest.approx(field.significance(sky), rel=0.02)
