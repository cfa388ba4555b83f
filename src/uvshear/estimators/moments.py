"""Shear from moments of visibility functions: the sum of the moments over the sum of their responses."""

from dataclasses import dataclass, field
from typing import ClassVar

import numpy as np

from uvshear.estimators.estimator import Estimator
from uvshear.estimators.kept_numbers import incomplete
from uvshear.estimators.sample import Sample
from uvshear.estimators.terms import Terms
from uvshear.execution.once import KeptOnce
from uvshear.shapes.deconvolution import holds
from uvshear.shapes.moments import REACH, SCALE, MomentFunctional
from uvshear.shapes.source_facet import Column, Kept, SourceFacet
from uvshear.shapes.statistic_flag import StatisticFlag
from uvshear.typing import Array, Bool, Complex, Float

ELLIPTICITY_SCATTER = 0.3
"""Standard deviation of M/R over galaxies without noise."""

RESPONSE = 1.5
"""R over the flux for a galaxy with a scale length of an arcsecond."""

_LONGEST = 1.5 * REACH * SCALE
"""Longest baseline to which the weight function may reach [wavelengths], whatever the error of the position."""

_MEMORY = 0.05e9
"""Memory for the functionals that are kept [bytes]; one takes a few hundred kilobytes."""


@dataclass(frozen=True)
class Moments(Estimator):
    """Moments of the visibility function about the catalogue's position.

    They are linear in the data and therefore have no noise bias, and they depend neither on a profile nor on a prior
    (``shapes.moments`` has the mathematics).

    Parameters
    ----------
    position_sigma
        Standard error of the catalogue's position in l and in m [rad].
    """

    position_sigma: float = 0.0
    _functionals: KeptOnce[MomentFunctional] = field(
        default_factory=lambda: KeptOnce(_MEMORY, MomentFunctional.size_of),
        repr=False,
        compare=False,
    )

    name = "moments"
    nanoseconds = 4e6
    columns: ClassVar = {
        "m1": Column("moment of u^2 - v^2 with weight exp(-k^2/2s^2), s = 15000 wavelengths", "Jy"),
        "m2": Column("moment of 2uv", "Jy"),
        "m_size": Column("moment of u^2 + v^2", "Jy"),
        "r11": Column("derivative of m1 with respect to the first component of the shear", "Jy"),
        "r12": Column(
            "derivative of m1 with respect to the second component, and of m2 with respect to the"
            " first",
            "Jy",
        ),
        "r22": Column("derivative of m2 with respect to the second component of the shear", "Jy"),
        "r_third": Column("coefficient of the third-order term in the shear, for m1 and m2", "Jy"),
        "m1_var": Column("variance of m1 due to noise", "Jy2"),
        "m2_var": Column("variance of m2 due to noise", "Jy2"),
        "m12_cov": Column("covariance of m1 and m2 due to noise", "Jy2"),
    }
    shape_columns = ("flux",)
    is_expanded = True

    def statistic(self, source: SourceFacet) -> Kept | StatisticFlag:
        """Measure the moments, with their responses and the covariance of their noise."""
        # Facets of one size and one beam differ only on long baselines, which moments do not use.
        facet = source.common.within(_LONGEST)
        if not facet.has_power:
            return StatisticFlag.NO_DATA

        def work_out() -> MomentFunctional:
            width = source.cells.size * source.cells.pixel
            power = np.asarray(facet.power, float)
            return MomentFunctional(facet.uv, power, width, self.position_sigma)

        functional = self._functionals.value(source.beam_key(_LONGEST), work_out)
        if not holds(functional.radius, source.prior):
            return StatisticFlag.TOO_LARGE
        unit = source.unit
        moments = functional.measure(facet.correlation)
        covariance = moments.covariance / unit**2
        return {
            "m1": float(moments.shape[0]) / unit,
            "m2": float(moments.shape[1]) / unit,
            "m_size": moments.size / unit,
            "r11": float(moments.response[0, 0]) / unit,
            "r12": float(moments.response[0, 1]) / unit,
            "r22": float(moments.response[1, 1]) / unit,
            "r_third": moments.third / unit,
            "m1_var": float(covariance[0, 0]),
            "m2_var": float(covariance[1, 1]),
            "m12_cov": float(covariance[0, 1]),
        }

    def damaged(self, sample: Sample) -> Bool[Array, " source"]:
        """Tell which sources have some numbers but not all, or a negative variance."""
        return incomplete(sample, self.columns, ("m1_var", "m2_var"))

    def terms(self, sample: Sample, about: Complex[Array, " source"]) -> Terms:
        r"""Return moments and responses, weighted by :func:`moment_weight`, to the third order in the shear.

        .. math:: \sum M = \sum \big[R + (\mathrm{tr} R/2 - 2 K) |g|^2\big]\, g

        K is the third order of ``shapes.moments``. The factor :math:`|g|^2` is that of the shear about which the terms
        are expanded; the ratio is exact to the fourth order where that shear is to the second.
        """
        value = np.stack([sample["m1"], sample["m2"]], axis=-1)
        r11, r12, r22 = sample["r11"], sample["r12"], sample["r22"]
        response = np.stack([r11, r12, r12, r22], axis=-1).reshape(-1, 2, 2)
        own = np.trace(response, axis1=-2, axis2=-1) / 2
        more = (own - 2 * sample["r_third"]) * np.abs(about) ** 2
        response = response + more[:, None, None] * np.eye(2)
        shear = np.stack([about.real, about.imag], axis=-1)
        value = value - np.einsum("sij,sj->si", response, shear)
        noise = (sample["m1_var"] + sample["m2_var"]) / 2
        return Terms(value, response).weighted(moment_weight(sample["flux"], noise))


def moment_weight(
    flux: Float[Array, " source"], variance: Float[Array, " source"]
) -> Float[Array, " source"]:
    r"""Weight of a galaxy's moments, from its flux in the catalogue [Jy] and the noise variance of M [Jy^2].

    .. math:: w = \frac{R}{\sigma_e^2 R^2 + \sigma_M^2},\quad R = 1.5 S

    It depends only on quantities that neither the shear nor the noise of the moments changes, unlike a fitted flux.
    """
    response = RESPONSE * flux
    return response / (ELLIPTICITY_SCATTER**2 * response**2 + variance)
