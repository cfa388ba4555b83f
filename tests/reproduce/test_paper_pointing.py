import math

import numpy as np
import pytest

from uvshear.interferometer.layout import load_layout
from uvshear.reproduce.paper_pointing import FROM_TRANSIT, LAYOUT, PaperPointing


def test_a_distance_from_the_zenith_is_counted_from_the_latitude():
    pointing = PaperPointing.from_zenith(math.radians(40), 900.0)
    assert pointing.declination == pytest.approx(load_layout(LAYOUT).latitude + math.radians(40))
    assert pointing.plan.track.elevation_limit is None


def test_eight_hours_in_samples_of_the_integration():
    hour_angles = PaperPointing(integration=3600.0).plan.track.samples
    assert len(hour_angles) == 8
    assert hour_angles.sum() == pytest.approx(0, abs=1e-12)
    later = PaperPointing(integration=3600.0, times=FROM_TRANSIT).plan.track.samples
    assert later.min() > 0


def test_weights_are_one():
    seen = PaperPointing(integration=7200.0).unit_visibilities()
    (block,) = seen.blocks
    assert len(block) == 4 * 197 * 196 // 2
    assert np.all(block.weights == 1)
