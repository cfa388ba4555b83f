r"""How clearly the data show a source, and how clearly they show that it is not a point.

With log L the logarithm of the likelihood, that of no source being 0, the significances are

.. math::
    \mathrm{detection} = \sqrt{2 \log L_\mathrm{galaxy}},\quad
    \mathrm{resolved} = \sqrt{2 (\log L_\mathrm{galaxy} - \log L_\mathrm{point})},

the galaxy being the most likely one and the point the one of the best flux and position.
"""

import math
from dataclasses import dataclass, replace

import numpy as np

from uvshear.galaxy import Profile
from uvshear.interferometer.facet import Facet
from uvshear.shapes.correlator import Correlator
from uvshear.shapes.measurement import FitFlag, GalaxyFit, ShapeMeasurement
from uvshear.shapes.point import fit_point
from uvshear.shapes.prior import ShapePrior

DETECTED = 5.0
"""Least ``detection`` of a source. The best galaxy near an empty place reaches it in one of a thousand places."""

RESOLVED = 4.0
"""Least ``resolved`` of a source. A point seems resolved to this degree in one of a thousand cases."""


@dataclass(frozen=True)
class Significance:
    """Significance of a source against no source, and of its extent against a point, in standard deviations."""

    detection: float
    resolved: float

    @property
    def flag(self) -> FitFlag:
        """Flag of a source whose fit succeeded."""
        if self.detection < DETECTED:
            return FitFlag.NOT_DETECTED
        return FitFlag.OK if self.resolved >= RESOLVED else FitFlag.UNRESOLVED


def with_significance(
    shape: ShapeMeasurement,
    facet: Facet,
    prior: ShapePrior,
    profile: Profile,
    fraction: float = 1.0,
) -> ShapeMeasurement:
    """Return a shape with its significances, flagged where these are too low.

    Parameters
    ----------
    shape
        Shape as it was measured.
    facet, prior, profile, fraction
        As for :func:`significance_of`.
    """
    if shape.best is None:
        return shape
    found = significance_of(facet, prior, profile, shape.best, fraction)
    quality = replace(shape.quality, detection=found.detection, resolved=found.resolved)
    flag = found.flag if shape.flag is FitFlag.OK else shape.flag
    return replace(shape, quality=quality, flag=flag)


def significance_of(
    facet: Facet, prior: ShapePrior, profile: Profile, galaxy: GalaxyFit, fraction: float = 1.0
) -> Significance:
    """Compare the most likely galaxy with no source and with a point.

    Parameters
    ----------
    facet
        Facet from which all other sources are subtracted.
    prior
        Prior of the source's position.
    profile
        Brightness profile of the galaxy.
    galaxy
        The most likely galaxy.
    fraction
        Fraction of the facet's information that is used, where its weights claim less noise than there is.
    """
    correlator = Correlator(facet, profile, np.float64)
    correlator.move_to(galaxy.offset / correlator.length)
    size = math.log(galaxy.scale_length)
    sums = correlator.normal_sums(
        correlator.form(galaxy.ellipticity, size),
        correlator.form_derivatives(galaxy.ellipticity, size),
    )
    against_nothing = max(float(sums.products[0]), 0.0) ** 2 / sums.norm
    point = fit_point(facet, prior, galaxy)
    against_point = against_nothing - (0.0 if point is None else point.snr**2)
    return Significance(
        detection=math.sqrt(fraction * against_nothing),
        resolved=math.sqrt(fraction * max(against_point, 0.0)),
    )
