import numpy as np

from tests.extraction.fields import field_of, pair
from uvshear.extraction.sky import with_fitted
from uvshear.shapes.measurement import GalaxyFit


def test_fitted_galaxies_replace_what_stood_in_the_sky_and_the_others_stay():
    observation, catalogue, _ = pair()
    field = field_of(observation, catalogue)
    fit = GalaxyFit(3e-3, np.array([1e-6, -2e-6]), 0.2j, 1e-5, 50.0)
    sky = with_fitted(field.sky, field, {1: fit})
    assert (sky.l[1], sky.m[1]) == (field.l[1] + 1e-6, field.m[1] - 2e-6)
    assert (sky.flux[1], sky.scale_length[1], sky.ellipticity[1]) == (3e-3, 1e-5, 0.2j)
    for name in ("l", "m", "flux", "scale_length", "ellipticity"):
        assert getattr(sky, name)[0] == getattr(field.sky, name)[0]
    assert field.sky.ellipticity[1] == 0
