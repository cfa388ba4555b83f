import numpy as np
import pytest

from uvshear.reproduce.crowded_field import EXTRACTIONS, CrowdedField
from uvshear.reproduce.paper_pointing import PaperPointing
from uvshear.reproduce.shape_sample import ShapeSample

POINTING = PaperPointing(integration=7200.0)


@pytest.mark.parametrize("way", EXTRACTIONS)
def test_a_field_is_simulated_and_measured(way):
    field = CrowdedField(way, POINTING, 10, 2.0, ring=5, seed=3)
    sample = ShapeSample.join([field.measured()])
    assert len(sample) == 10
    assert sample.is_good.sum() >= 7
    assert len(set(sample.galaxy.tolist())) == 2
    for ring in np.unique(sample.galaxy):
        assert abs(sample.true[sample.galaxy == ring].sum()) < 1e-9
    good = sample.select(sample.is_good)
    pulls = (good.measured - good.true).real / good.error[:, 0]
    assert np.abs(pulls).max() < 6
