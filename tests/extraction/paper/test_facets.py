import numpy as np
import pytest

from tests.extraction.fields import field_of, pair
from tests.skies import galaxies
from uvshear.constants import ARCSEC
from uvshear.extraction.paper.facets import INFORMATIVE, Target, spectral_gain
from uvshear.interferometer.uv_range import UvRange
from uvshear.shapes.measurement import GalaxyFit


def test_a_target_is_the_source_as_the_field_has_it():
    observation, catalogue, _ = pair()
    field = field_of(observation, catalogue)
    target = Target.from_field(field, 1)
    assert target.galaxy.flux.tolist() == [1.5e-3]
    assert target.scale_length == pytest.approx(2 * ARCSEC)
    assert target.frequency == 1.4e9
    assert target.half_width == 0
    fit = GalaxyFit(1e-3, np.zeros(2), 0.5, 2 * ARCSEC, 10.0)
    assert Target.from_field(field, 1, fit).half_width == fit.half_width


def test_baselines_that_tell_nothing_of_a_large_galaxy_are_left_out():
    large, small = (
        Target(galaxies(), size, UvRange(0.0, 1e5), 1.4e9) for size in (10 * ARCSEC, 0.1 * ARCSEC)
    )
    assert large.informative_uv_max == pytest.approx(INFORMATIVE / (10 * ARCSEC))
    assert small.informative_uv_max == 1e5


def test_the_gain_is_the_sources_own_power_law():
    gain = spectral_gain(galaxies(beta=-0.7), np.array([1.4e9, 2.8e9]))
    np.testing.assert_allclose(gain, [1, 2**-0.7])
