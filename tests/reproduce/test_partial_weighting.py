import numpy as np
import pytest

from tests.reproduce.surveys import POINTING
from uvshear.interferometer.weighting import RoundPsf, weighted
from uvshear.reproduce.partial_weighting import PartialWeighting


@pytest.mark.parametrize("part", [0.0, 0.5, 1.0])
def test_factors_are_between_1_and_those_of_the_whole(part):
    seen = POINTING.unit_visibilities()
    (block,) = seen.blocks
    whole = weighted(seen, (RoundPsf(),)).total_factors(block)
    partly = weighted(seen, (PartialWeighting(RoundPsf(), part),)).total_factors(block)
    np.testing.assert_allclose(partly, 1 + part * (whole - 1), rtol=1e-6)
    assert np.ptp(whole) > 0.1
