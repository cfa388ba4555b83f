r"""Galaxies that overlap, fitted together.

The joint likelihood of two galaxies that are closer to one another than their own size has a long, curved ridge. Fits
of one galaxy after the other move along it slowly, and an unchecked Gauss-Newton step leaves it. Here every step is
checked against the likelihood itself. With r_i the residual facet of source i (all models subtracted, as they are at
the start), P the beam on cells fine enough for the group, and d the change of the group's visibilities since the start,

.. math:: \Delta\log L = \sum_i \langle r_i, d_i \rangle - \tfrac{1}{2} \langle d, d \rangle_P .
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from uvshear.galaxy import Profile
from uvshear.interferometer.facet import BeamPlane, Facet
from uvshear.numerics.damped_newton import Ascent, Schedule, climb
from uvshear.shapes.measurement import GalaxyFit
from uvshear.shapes.normal_equations import real_product
from uvshear.shapes.prior import ShapePrior
from uvshear.shapes.template import PARAMETERS, Template, moved
from uvshear.typing import Array, Complex, Float

_SCHEDULE = Schedule(
    tolerance=1e-3, most_steps=30, first=1e-3, least=0.0, most=1e6, short=float("inf")
)


@dataclass(frozen=True)
class Member:
    """One source of a group.

    Parameters
    ----------
    residual
        Facet from which all models are subtracted, including that of the source; its centre is that of the source's
        prior.
    prior
        Prior of the source's shape, with the terms of a sky model.
    profile
        Brightness profile of the source.
    place
        Position of the facet's centre relative to the centre of the group [rad].
    """

    residual: Facet
    prior: ShapePrior
    profile: Profile
    place: tuple[float, float]


def fit_group(
    members: Sequence[Member], plane: BeamPlane, starts: Sequence[GalaxyFit]
) -> list[GalaxyFit]:
    """Most likely galaxies of a group, by damped Gauss-Newton steps of all members at once.

    Parameters
    ----------
    members
        Sources of the group.
    plane
        Beam on cells fine enough for the whole group.
    starts
        Galaxies that were subtracted from the residual facets.
    """
    group = _Group(members, plane, starts)
    summit = climb(group, _Trial(group, tuple(starts)), _SCHEDULE)
    return [
        replace(new, snr=old.snr * new.flux / old.flux)
        for new, old in zip(summit.point.fits, starts, strict=True)
    ]


@dataclass(frozen=True)
class _Trial:
    """Galaxies of the group; their normal equations are computed when a step is requested."""

    group: "_Group"
    fits: tuple[GalaxyFit, ...]

    @cached_property
    def normal_equations(self) -> tuple[Float[Array, " n"], Float[Array, "n n"]]:
        return self.group.normal_equations(self.fits)


class _Group(Ascent[_Trial, Array]):
    """The log posterior of a group as a function to climb."""

    def __init__(
        self, members: Sequence[Member], plane: BeamPlane, starts: Sequence[GalaxyFit]
    ) -> None:
        self._members, self._power = members, plane.power.astype(np.float32)
        self._own = [Template(member.residual.uv, member.profile) for member in members]
        self._common = [Template(plane.uv, member.profile, member.place) for member in members]
        self._data = [
            member.residual.correlation[None, :].astype(np.complex64) for member in members
        ]
        self._own_start = [t.model(fit) for t, fit in zip(self._own, starts, strict=True)]
        self._common_start = self._total(starts)

    def step(self, point: _Trial, damping: float) -> tuple[Float[Array, " n"], float]:
        """Return the step in the parameters of all galaxies."""
        gradient, information = point.normal_equations
        damped = information + damping * np.diag(np.diag(information))
        step = np.linalg.solve(damped, gradient)
        return step, float(gradient @ step)

    def trial(self, point: _Trial, step: Float[Array, " n"]) -> _Trial | None:
        """Return the galaxies after a step; None where a flux is no longer positive."""
        parts = step.reshape(-1, PARAMETERS)
        fits = tuple(moved(fit, part) for fit, part in zip(point.fits, parts, strict=True))
        return _Trial(self, fits) if all(fit.flux > 0 for fit in fits) else None

    def height(self, point: _Trial) -> float:
        """Return the log posterior."""
        return self.log_posterior(point.fits)

    def log_posterior(self, fits: Sequence[GalaxyFit]) -> float:
        """Log posterior up to a constant."""
        change = self._total(fits) - self._common_start
        score = -0.5 * float(np.sum(self._power * np.abs(change) ** 2, dtype=float))
        for k, fit in enumerate(fits):
            own = self._own[k].model(fit) - self._own_start[k]
            score += float(real_product(own[None, :], self._data[k])[0, 0])
            score -= 0.5 * self._members[k].prior.penalty(fit)
        return score

    def normal_equations(
        self, fits: Sequence[GalaxyFit]
    ) -> tuple[Float[Array, " n"], Float[Array, "n n"]]:
        """Gradient of the log posterior, and the Fisher matrix with the priors."""
        responses = np.concatenate(
            [t.responses(fit) for t, fit in zip(self._common, fits, strict=True)]
        )
        # The first response of each galaxy, to its flux, is its model for unit flux.
        flux = np.array([[fit.flux for fit in fits]], np.float32)
        change = flux @ responses[::PARAMETERS] - self._common_start
        weighted = responses * self._power
        information = real_product(weighted, responses)
        gradient = -real_product(weighted, change)[:, 0]
        for k, fit in enumerate(fits):
            rows = slice(k * PARAMETERS, (k + 1) * PARAMETERS)
            pull, precision = self._members[k].prior.pull(fit)
            gradient[rows] += real_product(self._own[k].responses(fit), self._data[k])[:, 0] + pull
            information[rows, rows] += np.diag(precision)
        return gradient, information

    def _total(self, fits: Sequence[GalaxyFit]) -> Complex[Array, " cell"]:
        return np.sum([t.model(f) for t, f in zip(self._common, fits, strict=True)], axis=0)
