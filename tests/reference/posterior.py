"""The posterior of (e1, e2) by brute force: every galaxy on a dense grid, against every visibility.

Flux uniform from zero: the integral of exp(S h - S^2 N/2) over S > 0 is sqrt(2 pi/N) exp(h^2/2N) Phi(h/sqrt(N)),
h = <d, m>, N = <m, m>. Position and ln alpha are summed over dense grids, uniform and normal; e is flat in a disc.
"""

from dataclasses import dataclass

import numpy as np
from scipy.special import log_ndtr


@dataclass(frozen=True)
class Posterior:
    """Density over (e1, e2) on a grid (sum 1), its mean and its covariance."""

    e1: np.ndarray
    e2: np.ndarray
    probability: np.ndarray

    @property
    def mean(self):
        return np.array([np.sum(self.probability * self.e1), np.sum(self.probability * self.e2)])

    @property
    def covariance(self):
        away = np.stack([self.e1, self.e2]) - self.mean[:, None, None]
        return np.einsum("iab,jab,ab->ij", away, away, self.probability)


def ellipticity_posterior(
    uv, vis, weights, envelope, *, e1, e2, positions, log_alpha, log_alpha_prior, e_max=0.95
):
    """Posterior on the grid e1 x e2.

    ``uv`` [wavelengths] is (k, 2); ``positions`` (p, 2) [rad] and ``log_alpha`` are grids of equal steps;
    ``log_alpha_prior`` is (mean, sigma); ``envelope`` is the profile's function of q = 4 pi^2 alpha^2 |A^-T k|^2.
    """
    u, v = uv.T
    phased = np.real(
        (weights * vis)[:, None] * np.exp(-2j * np.pi * uv @ positions.T)
    )  # (k, p): data with each position moved to the centre
    grid1, grid2 = np.meshgrid(e1, e2, indexing="ij")
    log_density = np.full(grid1.shape, -np.inf)
    for i, j in np.ndindex(grid1.shape):
        x, y = grid1[i, j], grid2[i, j]
        if np.hypot(x, y) >= e_max:
            continue
        inverse = np.linalg.inv(np.array([[1 - x, -y], [-y, 1 + x]]))
        k = inverse.T @ np.stack([u, v])
        q = 4 * np.pi**2 * np.exp(2 * log_alpha)[:, None] * np.sum(k**2, axis=0)
        model = envelope(q)  # (alpha, k)
        norm = model**2 @ weights
        significance = (model @ phased) / np.sqrt(norm)[:, None]
        log_integral = 0.5 * significance**2 + log_ndtr(significance) - 0.5 * np.log(norm)[:, None]
        deviation = (log_alpha - log_alpha_prior[0]) / log_alpha_prior[1]
        everything = log_integral - 0.5 * deviation[:, None] ** 2
        highest = everything.max()
        log_density[i, j] = highest + np.log(np.sum(np.exp(everything - highest)))
    probability = np.exp(log_density - log_density.max())
    return Posterior(grid1, grid2, probability / probability.sum())
