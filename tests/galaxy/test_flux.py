from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import quad

from uvshear.errors import InputError
from uvshear.galaxy import PowerLawFlux

LAWS = [PowerLawFlux(), PowerLawFlux(index=-1.0), PowerLawFlux(index=0.5, maximum=30e-6)]
EACH = pytest.mark.parametrize("law", LAWS, ids=repr)


def integral(law, low, high):
    return quad(lambda s: float(law.density(np.array([s]))[0]), low, high)[0]


@EACH
def test_density_is_a_normalised_power_between_its_bounds(law):
    assert integral(law, law.minimum, law.maximum) == pytest.approx(1, rel=1e-8)
    s = np.array([12e-6, 24e-6])
    low, high = law.density(s)
    assert high / low == pytest.approx(2**law.index, rel=1e-12)
    assert np.all(law.density(np.array([law.minimum * 0.99, law.maximum * 1.01])) == 0)


@EACH
def test_drawn_fluxes_follow_the_density(law):
    number = 100_000
    flux = law.draw(number, np.random.default_rng(3))
    edges = np.geomspace(law.minimum, law.maximum, 21)
    expected = np.array([number * integral(law, a, b) for a, b in pairwise(edges)])
    counts = np.histogram(flux, edges)[0]
    assert counts.sum() == number
    assert 5 < np.sum((counts - expected) ** 2 / expected) < 45  # 19 degrees of freedom


def test_bounds_out_of_order_are_refused():
    with pytest.raises(InputError, match="positive and below the maximum"):
        PowerLawFlux(minimum=2e-4, maximum=1e-5)
