"""Numba kernels of attenuations, over samples; ``uvw`` is (3, sample)."""

import math

import numpy as np

from uvshear.compilation import compiled
from uvshear.geometry.kernels import sine_cosine_of_turns, sine_cosine_of_turns_single


@compiled
def multiply_by_sinc(uvw, directions, scale, factors):  # type: ignore[no-untyped-def]
    """Multiply by sin(pi x)/(pi x), with x the product of ``scale`` and of the baseline with a direction.

    There is one direction for each row of ``factors``.
    """
    for s in range(len(factors)):
        a, b, c = directions[s]
        factor = factors[s]
        for i in range(factor.size):
            x = (uvw[0, i] * a + uvw[1, i] * b + uvw[2, i] * c) * scale[i]
            sine, _ = sine_cosine_of_turns(0.5 * x)
            factor[i] *= sine / (math.pi * x) if x != 0 else 1.0


@compiled
def multiply_by_sinc_single(uvw, directions, scale, factors):  # type: ignore[no-untyped-def]
    """Do the same as :func:`multiply_by_sinc` to 2e-7, in single precision and half the time."""
    for s in range(len(factors)):
        a, b, c = directions[s]
        factor = factors[s]
        for i in range(factor.size):
            x = (uvw[0, i] * a + uvw[1, i] * b + uvw[2, i] * c) * scale[i]
            sine, _ = sine_cosine_of_turns_single(0.5 * x)
            y = np.float32(math.pi * x)
            factor[i] *= sine / y if y != 0 else np.float32(1)


@compiled
def multiply_by_gaussian(moments, forms, factors):  # type: ignore[no-untyped-def]
    """Multiply each row by exp(moments . form), with the moments of each sample and the form of each row."""
    for s in range(len(factors)):
        form, factor = forms[s], factors[s]
        for i in range(factor.size):
            exponent = 0.0
            for k in range(form.size):
                exponent += moments[i, k] * form[k]
            factor[i] *= math.exp(exponent)


@compiled
def multiply_by_entries(tables, place, factors):  # type: ignore[no-untyped-def]
    """Multiply each row by the entry of its own table at each sample's place."""
    for s in range(len(factors)):
        table, factor = tables[s], factors[s]
        for i in range(factor.size):
            factor[i] *= table[place[i]]
