"""Chunks of visibilities with all that a reader may tell."""

from dataclasses import replace

import numpy as np

from uvshear.geometry.directions import PhaseCentre
from uvshear.interferometer.sample_counts import SampleCounts
from uvshear.interferometer.visibilities import Integrations, Visibilities, VisibilitySet

CENTRE = PhaseCentre(1.0, -0.5)
BASELINES = 20


def chunk(seed: int, integrations: int = 12, channels: int = 4, noise: float = 1.0) -> Visibilities:
    """Noise of ``noise`` times what the weights claim, on baselines of a kilometre or so."""
    rng = np.random.default_rng(seed)
    rows = BASELINES * integrations
    weights = rng.uniform(0.5, 2, (rows, channels))
    deviates = rng.standard_normal((2, rows, channels))
    weights[rng.uniform(size=weights.shape) < 0.1] = 0.0
    pair = np.tile(np.arange(BASELINES), integrations)
    vis = noise * (deviates[0] + 1j * deviates[1]) / np.sqrt(np.where(weights > 0, weights, 1))
    return Visibilities(
        rng.normal(0, 1e3, (rows, 3)),
        np.linspace(1e9, 1.1e9, channels) * (1 + 0.01 * seed),
        vis,
        weights,
        integrations=Integrations(
            np.column_stack([pair, pair + 1]),
            100.0 * seed + np.repeat(np.arange(integrations) * 8.0, BASELINES),
            np.full(rows, 8.0 + seed),
        ),
        counts=SampleCounts(
            rows=rows,
            samples=weights.size,
            usable=int((weights > 0).sum()),
            flagged=int((weights == 0).sum()),
        ),
    )


def observation(*seeds: int, noise: float = 1.0) -> VisibilitySet:
    """One chunk a seed."""
    return VisibilitySet(CENTRE, tuple(chunk(seed, noise=noise) for seed in seeds))


def without_weight(seen: Visibilities) -> Visibilities:
    """The same chunk with all of its weights zero."""
    return replace(seen, weights=np.zeros_like(seen.weights))
