"""log L = <d, m> - <m, m>/2 of galaxies on uv cells, and derivatives by central differences."""

import numpy as np

from tests.reference import plane

STEPS = (1e-4, 1e-4, 1e-4, 1e-4, 1e-4, 1e-4)
"""Relative to the flux, of e1, e2, ln alpha, and of the position in scale lengths."""


def galaxy(uv, theta, place=(0.0, 0.0), kind="exponential"):
    """Visibilities of (flux, e1, e2, ln alpha, l, m), the facet's centre at ``place``."""
    flux, e1, e2, log_alpha, l, m = theta
    offset = place[0] + l, place[1] + m
    return plane.galaxy(uv, flux, offset, complex(e1, e2), np.exp(log_alpha), kind)


def steps(theta):
    """Step of each parameter."""
    alpha = np.exp(theta[3])
    return np.array(STEPS) * (theta[0], 1, 1, 1, alpha, alpha)


def derivatives(function, theta):
    """Central differences of a function of the six parameters, one a row."""
    out = []
    for k, step in enumerate(steps(theta)):
        ahead, behind = np.array(theta, float), np.array(theta, float)
        ahead[k] += step
        behind[k] -= step
        out.append((function(ahead) - function(behind)) / (2 * step))
    return np.array(out)


def log_likelihood(uv, correlation, power, thetas, places, kind="exponential"):
    """Of galaxies together; ``correlation`` is that of all data on the cells."""
    model = sum(galaxy(uv, *pair, kind) for pair in zip(thetas, places, strict=True))
    return float(
        np.sum(np.real(correlation * np.conj(model))) - 0.5 * np.sum(power * np.abs(model) ** 2)
    )
