r"""Galaxies that overlap, fitted together.

The common likelihood of two galaxies at less than their own size from one another has a long, bent valley: fitted in
turn they creep along it, and a Gauss-Newton step that nobody checks leaves it. Here every step is checked against the
likelihood itself. With r_i the residual facet of source i (all models subtracted, as they are at the start), P the
beam on cells fine enough for the group, and d the change of the group's visibilities since the start,

.. math:: \Delta\log L = \sum_i \langle r_i, d_i \rangle - \tfrac{1}{2} \langle d, d \rangle_P .
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from uvshear.galaxy import Profile
from uvshear.interferometer.facet import BeamPlane, Facet
from uvshear.shapes.measurement import GalaxyFit
from uvshear.shapes.normal_equations import real_product
from uvshear.shapes.prior import ShapePrior
from uvshear.shapes.template import PARAMETERS, Template, moved
from uvshear.typing import Array, Complex, Float

_TOLERANCE = 1e-3
_MOST_STEPS = 30
_MOST_DAMPING = 1e6


@dataclass(frozen=True)
class Member:
    """One source of a group.

    Parameters
    ----------
    residual
        Facet with all models subtracted, its own too, centred where its prior puts it.
    prior
        Of its shape, a sky model's.
    profile
        Its brightness profile.
    place
        Of its facet's centre, from the centre of the group [rad].
    """

    residual: Facet
    prior: ShapePrior
    profile: Profile
    place: tuple[float, float]


def fit_group(
    members: Sequence[Member], plane: BeamPlane, starts: Sequence[GalaxyFit]
) -> list[GalaxyFit]:
    """Most likely galaxies of a group, by Levenberg-Marquardt steps of all at once."""
    group = _Group(members, plane, starts)
    fits = list(starts)
    score, damping = group.log_posterior(fits), 1e-3
    gradient, information = group.normal_equations(fits)
    for _ in range(_MOST_STEPS):
        damped = information + damping * np.diag(np.diag(information))
        step = np.linalg.solve(damped, gradient)
        if gradient @ step < _TOLERANCE:
            break
        parts = step.reshape(-1, PARAMETERS)
        trial = [moved(fit, part) for fit, part in zip(fits, parts, strict=True)]
        gain = -math.inf
        if all(fit.flux > 0 for fit in trial):
            gain = group.log_posterior(trial) - score
        if gain <= 0:
            damping *= 10
            if damping > _MOST_DAMPING:
                break
            continue
        fits, score, damping = trial, score + gain, damping / 10
        if gain < _TOLERANCE:
            break
        gradient, information = group.normal_equations(fits)
    return [
        replace(new, snr=old.snr * new.flux / old.flux)
        for new, old in zip(fits, starts, strict=True)
    ]


class _Group:
    def __init__(
        self, members: Sequence[Member], plane: BeamPlane, starts: Sequence[GalaxyFit]
    ) -> None:
        self._members, self._power = members, plane.power.astype(np.float32)
        self._own = [Template(one.residual.uv, one.profile) for one in members]
        self._common = [Template(plane.uv, one.profile, one.place) for one in members]
        self._data = [one.residual.correlation[None, :].astype(np.complex64) for one in members]
        self._own_start = [t.model(fit) for t, fit in zip(self._own, starts, strict=True)]
        self._common_start = self._total(starts)

    def log_posterior(self, fits: Sequence[GalaxyFit]) -> float:
        """Log posterior but for a constant."""
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
        """Gradient of the log posterior, and the Fisher information with the priors."""
        responses = np.concatenate(
            [t.responses(fit) for t, fit in zip(self._common, fits, strict=True)]
        )
        change = (self._total(fits) - self._common_start)[None, :]
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
