r"""Marginalisation of the likelihood over flux and position.

With a flux uniform from zero, the likelihood of a template at position x is, with h = <d, m> and N = <m, m>,

.. math:: L(x) \propto N^{-1/2}\, e^{h(x)^2/2N}\, \Phi(h(x)/\sqrt{N}).

For a bright galaxy its integral over x is a Gauss-Hermite sum about the best fit. At a signal-to-noise ratio of ten the
noise shows in h on the scale of the beam. A Gaussian with the peak and curvature of h itself (Rivi et al. 2016) then
fails for templates whose curvature is nearly singular, and templates of other ellipticities have their peak elsewhere,
out of reach of nodes about the best fit. For such galaxies the sum runs over a lattice of all positions at which any
ellipticity is likely.
"""

from dataclasses import dataclass
from typing import Self

import numpy as np
from scipy.spatial import KDTree
from scipy.special import log_ndtr

from uvshear.shapes.correlator import Correlator
from uvshear.shapes.interpolative import DecomposedCorrelator
from uvshear.shapes.lattices import hexagonal_lattice
from uvshear.shapes.maximum import BestFit
from uvshear.shapes.posterior_modes import PosteriorModes
from uvshear.typing import Array, Complex, Float

_NODES, _WEIGHTS = np.polynomial.hermite_e.hermegauss(4)


@dataclass(frozen=True)
class MarginalLikelihood:
    """Likelihood of each template with flux and position integrated out, in the correlator's units.

    Parameters
    ----------
    log_likelihood
        Log likelihood up to a constant.
    flux, flux_variance
        Mean and variance of the flux, given the template.
    norm
        <m, m> of the template.
    offset, offset_variance
        Mean of the position relative to the best fit, and its variance along each axis, given the template.
    """

    log_likelihood: Float[Array, " sample"]
    flux: Float[Array, " sample"]
    flux_variance: Float[Array, " sample"]
    norm: Float[Array, " sample"]
    offset: Float[Array, "sample 2"]
    offset_variance: Float[Array, "sample 2"]


class PositionQuadrature:
    """Nodes over the position, relative to the best fit on which the correlator is centred."""

    def __init__(
        self,
        correlator: Correlator | DecomposedCorrelator,
        nodes: Float[Array, "node 2"],
        log_weights: Float[Array, " node"],
    ) -> None:
        self._correlator, self._nodes, self._log_weights = correlator, nodes, log_weights
        self._displaced = correlator.displaced_to(nodes)

    @classmethod
    def from_best_fit(
        cls, correlator: Correlator | DecomposedCorrelator, best: BestFit, radius: float
    ) -> Self:
        """Gauss-Hermite nodes about the best fit, within ``radius`` of the facet's centre where the prior ends."""
        z = np.stack(np.meshgrid(_NODES, _NODES), axis=-1).reshape(-1, 2)
        weights = np.outer(_WEIGHTS, _WEIGHTS).ravel()
        # The four corners hold a thousandth of the sum and cost a quarter of it.
        inner = np.hypot(*z.T) < 3
        z, weights = z[inner], weights[inner]
        # The nodes are a fifth wider than the Fisher covariance, whose Gaussian falls off faster than the likelihood.
        width = np.linalg.cholesky(1.2 * np.linalg.inv(best.position_information))
        nodes, log_weights = z @ width.T, np.log(weights) + 0.5 * np.sum(z**2, axis=1)
        allowed = np.hypot(*(nodes + best.position).T) <= radius
        if not allowed.any():
            allowed[:] = True
        return cls(correlator, nodes[allowed], log_weights[allowed])

    @classmethod
    def from_modes(
        cls, correlator: Correlator | DecomposedCorrelator, modes: PosteriorModes
    ) -> Self:
        """Hexagonal lattice over all likely positions, 1.5 standard deviations of the position apart."""
        reach = 0.6 * modes.spacing
        furthest = float(np.hypot(*modes.positions.T).max()) + reach
        lattice = hexagonal_lattice(furthest, 1.5 * modes.sigma)
        distance, _ = KDTree(modes.positions).query(lattice, distance_upper_bound=reach)
        nodes = lattice[np.isfinite(distance)]
        if len(nodes) == 0:
            # The few likely positions of a fit that has not found the peak may lie between all points of the lattice.
            nodes = modes.positions
        return cls(correlator, nodes, np.zeros(len(nodes)))

    def marginalise(
        self, ellipticity: Complex[Array, " sample"], log_scale_length: Float[Array, " sample"]
    ) -> MarginalLikelihood:
        """Likelihood of each template with flux and position integrated out."""
        heights, norm = self._correlator.correlate(ellipticity, log_scale_length, self._displaced)
        # A template that the baselines do not reach has no norm, and no likelihood.
        reached = norm > 0
        norm, heights = np.where(reached, norm, 1.0), np.where(reached[:, None], heights, 0.0)
        significance = heights / np.sqrt(norm)[:, None]
        log_node = self._log_weights + 0.5 * significance**2 + log_ndtr(significance)
        highest = log_node.max(axis=1)
        probability = np.exp(log_node - highest[:, None])
        total = probability.sum(axis=1)
        probability /= total[:, None]

        flux, variance = _positive_flux(significance)
        flux, variance = flux / np.sqrt(norm)[:, None], variance / norm[:, None]
        mean_flux = np.sum(probability * flux, axis=1)
        flux_scatter = (flux - mean_flux[:, None]) ** 2
        offset = probability @ self._nodes
        return MarginalLikelihood(
            log_likelihood=np.where(reached, highest + np.log(total) - 0.5 * np.log(norm), -np.inf),
            flux=mean_flux,
            flux_variance=np.sum(probability * (variance + flux_scatter), axis=1),
            norm=norm,
            offset=offset,
            offset_variance=probability @ self._nodes**2 - offset**2,
        )


def _positive_flux(
    significance: Float[Array, "sample node"],
) -> tuple[Float[Array, "sample node"], Float[Array, "sample node"]]:
    """Mean and variance of a normal distribution of unit variance about ``significance``, truncated at zero."""
    # Far below zero the truncated normal is an exponential, and the difference of squares would lose all digits.
    significance = np.maximum(significance, -1e4)
    hazard = np.exp(-0.5 * significance**2 - log_ndtr(significance)) / np.sqrt(2 * np.pi)
    return significance + hazard, np.maximum(1 - hazard * (significance + hazard), 0.0)
