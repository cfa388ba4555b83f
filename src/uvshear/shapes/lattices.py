"""Coarse lattices of positions and shapes, on which a fit looks for starting points."""

import math

import numpy as np

from uvshear.typing import Array, Complex, Float


def hexagonal_lattice(radius: float, spacing: float) -> Float[Array, "sample 2"]:
    """Points of a hexagonal lattice within a radius of the origin, which is one of them."""
    reach = math.ceil(radius / spacing) + 1
    i, j = np.mgrid[-reach : reach + 1, -reach : reach + 1]
    points = np.stack([i + 0.5 * j, math.sqrt(0.75) * j], axis=-1).reshape(-1, 2) * spacing
    return points[np.hypot(*points.T) <= radius * (1 + 1e-9)]


def shape_lattice() -> tuple[Complex[Array, " sample"], Float[Array, " sample"]]:
    """13 ellipticities in all directions, each with three sizes in standard deviations of the prior."""
    angles = np.exp(2j * math.pi * np.arange(6) / 6)
    ellipticity = np.concatenate([[0], 0.3 * angles, 0.6 * angles * np.exp(1j * math.pi / 6)])
    steps = np.array([-1.0, 0.0, 1.0])
    return np.repeat(ellipticity, 3), np.tile(steps, len(ellipticity))
