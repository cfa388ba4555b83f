r"""Flux and position out of the likelihood.

With a flux uniform from zero, the likelihood of a template at position x is, with h = <d, m> and N = <m, m>,

.. math:: L(x) \propto N^{-1/2}\, e^{h(x)^2/2N}\, \Phi(h(x)/\sqrt{N}).

Its integral over x is a Gauss-Hermite sum about the best fit of a bright galaxy. At a signal-to-noise ratio of ten
the noise shows in h on the scale of the beam: a Gaussian put on h's own peak and curvature (Rivi et al. 2016 do that)
then meets templates whose curvature is all but singular, and believes them; and templates of another ellipticity have
their peak somewhere else, out of the reach of nodes about the best. There the sum is over a lattice of all positions
where any ellipticity is likely.
"""

from dataclasses import dataclass
from typing import Self

import numpy as np
from scipy.spatial import KDTree
from scipy.special import log_ndtr

from uvshear.shapes.correlator import Correlator
from uvshear.shapes.interpolative import CondensedCorrelator
from uvshear.shapes.lattices import hexagonal_lattice
from uvshear.shapes.maximum import BestFit
from uvshear.shapes.posterior_modes import Likely
from uvshear.typing import Array, Complex, Float

_NODES, _WEIGHTS = np.polynomial.hermite_e.hermegauss(4)
_INFLATION = 1.2

_STEP = 1.5
"""Spacing of the lattice over the standard deviation of the position."""


@dataclass(frozen=True)
class MarginalLikelihood:
    """One line a template, in the correlator's units: log L up to a constant, and what goes with the template.

    ``offset`` counts from the best fit.
    """

    log_likelihood: Float[Array, " sample"]
    flux: Float[Array, " sample"]
    flux_variance: Float[Array, " sample"]
    norm: Float[Array, " sample"]
    offset: Float[Array, "sample 2"]
    offset_variance: Float[Array, "sample 2"]


class PositionQuadrature:
    """Nodes over the position, counted from the best fit on which the correlator is centred."""

    def __init__(
        self,
        correlator: Correlator | CondensedCorrelator,
        nodes: Float[Array, "node 2"],
        log_weights: Float[Array, " node"],
    ) -> None:
        self._correlator, self._nodes, self._log_weights = correlator, nodes, log_weights
        self._displaced = correlator.displaced_to(nodes)

    @classmethod
    def about(
        cls, correlator: Correlator | CondensedCorrelator, best: BestFit, radius: float
    ) -> Self:
        """Gauss-Hermite nodes, wider by a fifth than the best fit's Fisher covariance.

        The prior of the position ends at ``radius`` from the facet's centre.
        """
        z = np.stack(np.meshgrid(_NODES, _NODES), axis=-1).reshape(-1, 2)
        weights = np.outer(_WEIGHTS, _WEIGHTS).ravel()
        # The four corners hold a thousandth of the sum and cost a quarter of it.
        inner = np.hypot(*z.T) < 3
        z, weights = z[inner], weights[inner]
        width = np.linalg.cholesky(_INFLATION * np.linalg.inv(best.position_information))
        nodes, log_weights = z @ width.T, np.log(weights) + 0.5 * np.sum(z**2, axis=1)
        allowed = np.hypot(*(nodes + best.position).T) <= radius
        if not allowed.any():
            allowed[:] = True
        return cls(correlator, nodes[allowed], log_weights[allowed])

    @classmethod
    def over(cls, correlator: Correlator | CondensedCorrelator, likely: Likely) -> Self:
        """Hexagonal lattice over all likely positions."""
        reach = 0.6 * likely.spacing
        furthest = float(np.hypot(*likely.positions.T).max()) + reach
        lattice = hexagonal_lattice(furthest, _STEP * likely.sigma)
        distance, _ = KDTree(likely.positions).query(lattice, distance_upper_bound=reach)
        nodes = lattice[np.isfinite(distance)]
        return cls(correlator, nodes, np.zeros(len(nodes)))

    def marginalise(
        self, ellipticity: Complex[Array, " sample"], log_scale_length: Float[Array, " sample"]
    ) -> MarginalLikelihood:
        """Likelihood of each template, flux and position integrated out."""
        heights, norm = self._correlator.correlate(ellipticity, log_scale_length, self._displaced)
        # A template out of the reach of the baselines has no norm, and no likelihood.
        reached = norm > 0
        norm, heights = np.where(reached, norm, 1.0), np.where(reached[:, None], heights, 0.0)
        significance = heights / np.sqrt(norm)[:, None]
        log_node = self._log_weights + 0.5 * significance**2 + log_ndtr(significance)
        highest = log_node.max(axis=1)
        share = np.exp(log_node - highest[:, None])
        total = share.sum(axis=1)
        share /= total[:, None]

        flux, variance = _positive_flux(significance)
        flux, variance = flux / np.sqrt(norm)[:, None], variance / norm[:, None]
        mean_flux = np.sum(share * flux, axis=1)
        offset = share @ self._nodes
        return MarginalLikelihood(
            log_likelihood=np.where(reached, highest + np.log(total) - 0.5 * np.log(norm), -np.inf),
            flux=mean_flux,
            flux_variance=np.sum(share * (variance + (flux - mean_flux[:, None]) ** 2), axis=1),
            norm=norm,
            offset=offset,
            offset_variance=share @ self._nodes**2 - offset**2,
        )


def _positive_flux(
    significance: Float[Array, "sample node"],
) -> tuple[Float[Array, "sample node"], Float[Array, "sample node"]]:
    """Mean and variance of a normal of unit variance about ``significance``, cut off below zero."""
    # Far below zero the cut-off normal is an exponential; the difference of squares would lose all digits.
    significance = np.maximum(significance, -1e4)
    hazard = np.exp(-0.5 * significance**2 - log_ndtr(significance)) / np.sqrt(2 * np.pi)
    return significance + hazard, np.maximum(1 - hazard * (significance + hazard), 0.0)
