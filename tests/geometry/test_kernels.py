import math

import numba
import numpy as np
import pytest

from uvshear.geometry.kernels import sine_cosine_of_turns


@numba.njit
def _of_all(turns, sine, cosine):  # pragma: no cover
    for i in range(turns.size):
        sine[i], cosine[i] = sine_cosine_of_turns(turns[i])


@pytest.mark.parametrize("largest", [0.5, 1e4])
def test_sine_and_cosine_of_turns_are_those_of_the_library(largest):
    turns = np.concatenate(
        [np.random.default_rng(3).uniform(-largest, largest, 20_000), [0, 0.25, 0.5, -0.5, 0.75]]
    )
    sine, cosine = np.empty_like(turns), np.empty_like(turns)
    _of_all(turns, sine, cosine)
    within = 2 * math.pi * (turns - np.rint(turns))
    # a dropped term of the series: 3e-11
    np.testing.assert_allclose(sine, np.sin(within), rtol=0, atol=5e-13)
    np.testing.assert_allclose(cosine, np.cos(within), rtol=0, atol=5e-13)
