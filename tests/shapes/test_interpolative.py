"""Templates on a few of the cells against the sums over all cells."""

import numpy as np
import pytest

from uvshear.constants import ARCSEC
from uvshear.galaxy import Exponential
from uvshear.interferometer.facet import Facet
from uvshear.shapes.correlator import Correlator
from uvshear.shapes.interpolative import (
    DecomposedCorrelator,
    DecompositionCache,
    TemplateDecomposition,
)
from uvshear.shapes.prior import ShapePrior

PROFILE = Exponential()
MIDDLE = float(np.log(ARCSEC))
PRIOR = ShapePrior(MIDDLE, 0.3)


def _facet(seed=0, tilt=0.0):
    """Noise seen with a beam whose power falls steeply, and has gaps."""
    rng = np.random.default_rng(seed)
    spacing = 1 / (45 * ARCSEC)
    i, j = np.meshgrid(np.arange(-40, 41), np.arange(41), indexing="ij")
    kept = (np.hypot(i, j) <= 40) & ((j > 0) | (i >= 0))
    uv = spacing * np.column_stack([i[kept], j[kept]]).astype(float)
    distance = np.hypot(uv[:, 0] * (1 + tilt), uv[:, 1]) / spacing
    power = 1e12 / (1 + (distance / 3) ** 2)
    power[np.random.default_rng(9).uniform(size=len(power)) < 0.2] = 0
    noise = np.sqrt(power) * (rng.normal(size=len(uv)) + 1j * rng.normal(size=len(uv)))
    return Facet(uv, noise, power)


@pytest.fixture(scope="module")
def decomposition():
    return DecompositionCache(PROFILE).decomposition(_facet(), "cells", PRIOR)


def _shapes(number):
    rng = np.random.default_rng(5)
    e = 0.9 * np.sqrt(rng.uniform(size=number)) * np.exp(2j * np.pi * rng.uniform(size=number))
    return e, MIDDLE + 0.3 * rng.uniform(-4, 4, number)


@pytest.mark.parametrize("tilt", [0.0, 0.1])
def test_correlations_are_those_of_all_cells(decomposition, tilt):
    """Of this facet's weights, and of weights that are a little others."""
    correlator = Correlator(_facet(seed=3, tilt=tilt), PROFILE)
    decomposed = DecomposedCorrelator(correlator, decomposition)
    e, size = _shapes(300)
    nodes = np.random.default_rng(1).normal(size=(5, 2))
    exact, exact_norm = correlator.correlate(e, size, correlator.displaced_to(nodes))
    got, norm = decomposed.correlate(e, size, decomposed.displaced_to(nodes))
    # In units of the noise of each template: measured 0.001 rms, 0.009 for a template hardly seen; norms 3e-4, 0.002.
    away = (got - exact) / np.sqrt(exact_norm)[:, None]
    assert np.sqrt(np.mean(away**2)) < 2e-3
    assert np.max(np.abs(away)) < 0.02
    assert np.max(np.abs(norm / exact_norm - 1)) < 5e-3


def test_few_cells_are_enough(decomposition):
    cells = len(_facet().uv)
    assert len(decomposition.values.cells) < cells / 7
    assert len(decomposition.squares.cells) < cells / 7


def test_on_its_own_cells_a_template_is_itself(decomposition):
    spread = decomposition.values.coefficients
    np.testing.assert_array_equal(
        spread[:, decomposition.values.cells], np.eye(len(spread), dtype=np.float32)
    )


def test_what_was_made_is_kept_and_shared_by_sizes_alike():
    cache, facet = DecompositionCache(PROFILE), _facet()
    first = cache.decomposition(facet, "cells", PRIOR)
    assert cache.decomposition(facet, "cells", ShapePrior(MIDDLE + 0.01, 0.3)) is first
    assert isinstance(
        cache.decomposition(facet, "cells", ShapePrior(MIDDLE + 0.5, 0.3)), TemplateDecomposition
    )
    assert cache.decomposition(facet, "cells", ShapePrior(MIDDLE + 0.5, 0.3)) is not first
