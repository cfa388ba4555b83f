"""Between two visits of the visibilities: sources are fitted until none moves any more.

First in decreasing flux among neighbours (``extraction.schedule``), side by side where far apart, each source against
what the last visit left, less what its neighbours have changed since (``extraction.interaction``). All at once, each
by itself, would diverge; in turn it is the Gauss-Seidel iteration, which never lowers the common likelihood. It
finds the right peaks, and those that overlap are fitted together (``fit.blend``). Then all take one Gauss-Newton step
together (``measurement.joint``): the broad plateau of the beam lets whole neighbourhoods creep where each waits for the
others.
"""

import math
from collections.abc import Callable, Mapping, Sequence

import numpy as np
from scipy.spatial import cKDTree

from uvshear.constants import ARCSEC
from uvshear.execution import Executor
from uvshear.extraction.converged.beams import Beams
from uvshear.extraction.converged.groups import overlapping_groups
from uvshear.extraction.converged.interaction import Interaction, Source
from uvshear.extraction.converged.joint_step import (
    BlockOf,
    Couplings,
    Freedom,
    couple,
    freedom,
    joint_step,
)
from uvshear.extraction.converged.plan import VisitPlan
from uvshear.extraction.converged.sources import ModelledSource
from uvshear.extraction.schedule import fitting_levels
from uvshear.imaging.cutout import Cutout
from uvshear.interferometer.facet import Facet
from uvshear.shapes.blend import Member, fit_group
from uvshear.shapes.measurement import GalaxyFit
from uvshear.shapes.normal_equations import NormalEquations, normal_equations
from uvshear.shapes.template import Template, difference
from uvshear.typing import Array, Bool, Complex, Float, Int

SEPARATION = 60 * ARCSEC
"""Sources closer than this are fitted one after the other, the brighter first."""

NEAR = 15 * ARCSEC
"""Neighbours within this distance, free, count in the errors of a source."""

MOST_NEIGHBOURS = 8
"""So many of them at most, the nearest first."""


MOST_ROUNDS = 4

SETTLED = 0.1
"""Rounds end when all together move by this part of what the first moved them: what sources do to one another between
visits is known no better, and the next visit measures it."""

SETTLED_ENOUGH = 0.5
"""And when they move by less than this part of the tolerance."""

RELEASES = 3
"""Times that a released sky settles: thirty galaxies, 17 to a square arcminute, lose 10.3 % of their moments held,
3.0 % after one time, 1.0 after two and 0.5 after three with the step ahead, 0.4 after twelve."""

FARTHEST_AHEAD = 1.0
"""Of the last move, at most, that a released sky is carried on by."""

Tick = Callable[[], None]


class Settlement:
    """The sources of a field after a visit of the visibilities, settling."""

    def __init__(
        self,
        sources: Sequence[ModelledSource],
        fits: Sequence[GalaxyFit],
        plan: VisitPlan,
        beams: Beams,
        residuals: Sequence[Complex[Array, " _"]],
        couplings: Couplings | None = None,
    ) -> None:
        self._sources, self._plan, self._beams = sources, plan, beams
        self._residuals = residuals
        """Once a source has been looked at: with its own model of the visit put back, see ``_put_back``."""
        self._is_put_back = np.zeros(len(sources), bool)
        self._reference = list(fits)
        self.fits = list(fits)
        self._interaction = Interaction(plan, beams, sources[0].profile)
        self._place = plan.place * plan.pixel + plan.offset
        self._flux = np.array([source.expected.flux for source in sources])
        self._tree = cKDTree(self._place)
        size = np.array(
            [
                max(source.expected.scale_length, fit.scale_length)
                for source, fit in zip(sources, fits, strict=True)
            ]
        )
        self._units = overlapping_groups(self._place, size)
        self._is_grouped = np.zeros(len(sources), bool)
        self._is_grouped[[k for unit in self._units if len(unit) > 1 for k in unit]] = True
        self._equations: dict[int, NormalEquations] = {}
        self.couplings = couplings
        """Those given are scaled with the fluxes; else they are worked out in the first round."""

    def settle(
        self, tolerance: float, executor: Executor, *, afresh: bool, tick: Tick
    ) -> list[tuple[float, float]]:
        """Fit in turn and step together, until no source changes by ``tolerance`` of the noise.

        ``afresh`` looks for the peak of every source anew. Returned are the largest changes of each round, in turn
        and together.
        """
        rounds: list[tuple[float, float]] = []
        enough = 0.0
        active = np.ones(len(self._sources), bool)
        for number in range(MOST_ROUNDS):
            in_turn = self._sweep(active, executor, afresh=afresh and number == 0, tick=tick)
            together = self._step(executor, tolerance)
            rounds.append((float(in_turn.max()), float(together.max())))
            enough = enough or max(SETTLED * _rms(in_turn), SETTLED_ENOUGH * tolerance)
            # Those that overlap are fitted together from the second round on.
            if _rms(together) < enough and not (afresh and number == 0):
                break
            restless = np.flatnonzero(np.maximum(in_turn, together) > tolerance)
            if len(restless) == 0:
                break
            active[:] = False
            for neighbours in self._tree.query_ball_point(self._place[restless], NEAR):
                active[neighbours] = True
        return rounds

    def release(self, tolerance: float, executor: Executor, tick: Tick) -> list[float]:
        """Settle once more with next to no prior on the ellipticities of the sky.

        A prior holds a faint galaxy back, towards a circle, and all its neighbours, near and far, take a little of
        what it lacks: of its shape, and so of the shear. Without the prior the sky settles by about half a time: a
        few times are followed by what the others would add, as far as their moves tell. Returned is by how much of
        the noise (rms) the sky moved each time.
        """
        self._sources = [source.released() for source in self._sources]
        moves = []
        for _ in range(RELEASES):
            before = list(self.fits)
            self.settle(tolerance, executor, afresh=False, tick=tick)
            moves.append(_rms(self._moved_since(before)))
        first, second = moves[-2:]
        # Moves that do not shrink tell of no end.
        ahead = min(second / (first - second), FARTHEST_AHEAD) if second < first else 0.0
        pairs = zip(self._sources, before, self.fits, strict=True)
        after = [_ahead(source, then, now, ahead) for source, then, now in pairs]
        self._change(list(range(len(after))), after, executor)
        return moves

    def _sweep(
        self, active: Bool[Array, " source"], executor: Executor, *, afresh: bool, tick: Tick
    ) -> Float[Array, " source"]:
        """Fit the active sources in turn, those that overlap together; return by how much of the noise each moved."""

        def fit(unit: list[int]) -> list[GalaxyFit]:
            if len(unit) > 1 and all(self.fits[source].snr > 0 for source in unit):
                return self._fit_group(unit)
            return [self._fit(source, afresh=afresh) for source in unit]

        # Steps of a group need a start: afresh, each fits for itself.
        singles = [[source] for source in range(len(self._sources))]
        units = [unit for unit in (singles if afresh else self._units) if active[unit].any()]
        moved = np.zeros(len(self._sources))
        if not units:
            return moved
        centres = np.array([self._place[unit].mean(axis=0) for unit in units])
        flux = np.array([self._flux[unit].max() for unit in units])
        for level in fitting_levels(centres, flux, SEPARATION):
            together = [units[k] for k in level.tolist()]
            after: list[GalaxyFit] = []
            for fits in executor.map(fit, together):
                after += fits
                tick()
            members = [source for unit in together for source in unit]
            before = {source: self.fits[source] for source in members}
            moved[members] = self._change(members, after, executor)
            for unit in together:
                if len(unit) > 1:
                    moved[unit] = self._unit_distance(unit, before)
        return moved

    def _fit(self, source: int, *, afresh: bool) -> GalaxyFit:
        last = self.fits[source]
        starts = (None, last) if afresh else (last,)
        return self._sources[source].refit(self.facet(source), starts if last.snr > 0 else (None,))

    def _fit_group(self, group: list[int]) -> list[GalaxyFit]:
        members = [self._member(source, group[0]) for source in group]
        plane = self._interaction.plane(int(self._beams.nearest[group[0]]))
        return fit_group(members, plane, [self.fits[source] for source in group])

    def _step(self, executor: Executor, tolerance: float) -> Float[Array, " source"]:
        """One Gauss-Newton step of all sources but those in groups; return by how much of the noise each moved."""
        everyone = list(range(len(self._sources)))
        self._linearise(everyone, executor)
        if self.couplings is None:
            self.couplings = self._couple(executor)
        steps = joint_step(
            [self._equations[k] for k in everyone],
            self.couplings,
            np.array([fit.flux for fit in self.fits]),
            self._is_grouped | np.array([self._is_stuck(k) for k in everyone]),
        )
        after = [self._sources[k].after(self.fits[k], step) for k, step in enumerate(steps)]
        far = np.array([self._step_length(k, new) for k, new in enumerate(after)])
        movers = np.flatnonzero(far > tolerance / 5).tolist()
        self._change(movers, [after[k] for k in movers], executor)
        return far

    def _is_stuck(self, source: int) -> bool:
        """Whether a source stands where no step leads on: as expected, for no fit found it, or at the edge of e."""
        fit, largest = self.fits[source], self._sources[source].prior.ellipticity.maximum
        return fit.snr <= 0 or abs(fit.ellipticity) > 0.99 * largest

    def _member(self, source: int, first: int) -> Member:
        one = self._sources[source]
        place = tuple(self._place[source] - self._place[first])
        return Member(self._facet(source, with_own=False), one.prior, one.profile, place)

    def _linearise(self, members: Sequence[int], executor: Executor) -> None:
        def equations(source: int) -> NormalEquations:
            one = self._sources[source]
            facet = self._facet(source, with_own=False)
            return normal_equations(facet, one.prior, one.profile, self.fits[source])

        found = executor.map(equations, members)
        self._equations.update(zip(members, found, strict=True))

    def _couple(self, executor: Executor) -> Couplings:
        profile = self._sources[0].profile
        return couple(self._place, self.fits, self._beams, self._interaction, profile, executor)

    def facet(self, source: int) -> Facet:
        """Facet of a source, everything else subtracted as it is now."""
        return self._facet(source, with_own=True)

    def residual(self, source: int) -> Facet:
        """Facet of a source, everything subtracted as it is now, the source too."""
        return self._facet(source, with_own=False)

    def changes(self) -> Float[Array, " source"]:
        """Change of each source since the visit, in units of the noise; of a group, that of its sum."""
        return self._moved_since(self._reference)

    def _moved_since(self, before: Sequence[GalaxyFit]) -> Float[Array, " source"]:
        moved = np.zeros(len(self._sources))
        for unit in self._units:
            moved[unit] = self._unit_distance(unit, before)
        return moved

    def cutout(self, source: int) -> Cutout:
        """Cells of a source's facet."""
        return self._plan.cutouts[source]

    def freedoms(self, chosen: Int[Array, " chosen"]) -> list[Freedom | None]:
        """Tell what free neighbours mean for sources; None for one that has none near."""
        if self.couplings is None:
            return [None] * len(chosen)
        block_of = BlockOf(self.couplings, np.array([fit.flux for fit in self.fits]))
        return [self._freedom(source, block_of) for source in chosen.tolist()]

    def _freedom(self, source: int, block_of: BlockOf) -> Freedom | None:
        near = self._tree.query_ball_point(self._place[source], NEAR)
        others = [other for other in near if other != source and self.fits[other].snr > 0]
        if not others or self.fits[source].snr <= 0:
            return None
        apart = np.hypot(*(self._place[others] - self._place[source]).T)
        nearest = [others[k] for k in np.argsort(apart, kind="stable")[:MOST_NEIGHBOURS]]
        prior, fit = self._sources[source].prior, self.fits[source]
        (pull, precision), (own_pull, own_precision) = prior.pull(fit), prior.measured.pull(fit)
        sky_prior = pull - own_pull, precision - own_precision
        return freedom(source, nearest, self._equations, block_of, sky_prior)

    def _change(
        self, members: list[int], after: list[GalaxyFit], executor: Executor
    ) -> Float[Array, " member"]:
        """Let sources change; return by how much of the noise."""

        def render(task: tuple[int, GalaxyFit, GalaxyFit]) -> tuple[float, Float[Array, "l m"]]:
            source, old, new = task
            return self._interaction.rendered(
                source, self._seen(source, old), self._seen(source, new)
            )

        tasks = [(k, self.fits[k], new) for k, new in zip(members, after, strict=True)]
        moved_by = np.zeros(len(members))
        for place, (distance, rendered) in enumerate(executor.map(render, tasks)):
            source, _, new = tasks[place]
            self._interaction.add(source, rendered)
            self.fits[source] = new
            moved_by[place] = distance
        pairs = zip(self.fits, self._reference, strict=True)
        self._interaction.change_flux(np.array([now.flux - then.flux for now, then in pairs]))
        return moved_by

    def _facet(self, source: int, *, with_own: bool) -> Facet:
        """Facet with everything subtracted but, if asked for, the source's own model."""
        cutout = self._plan.cutouts[source]
        power = self._beams.power(source, cutout)
        correlation = np.zeros(len(power), np.complex64)
        self._interaction.subtract_from(correlation, source)
        correlation *= cutout.recentring(tuple(self._plan.offset[source]))
        correlation += self._put_back(source)
        # The interaction has taken its own change away, too.
        held = self._interaction.own_power(source)
        present = self._sources[source].model(self.fits[source], cutout.uv)
        correlation += (held if with_own else held - power) * present
        return Facet(cutout.uv, correlation, power)

    def _put_back(self, source: int) -> Complex[Array, " cell"]:
        """Residual of the visit with the source's model of then, as much of it as the interaction does not hold."""
        if not self._is_put_back[source]:
            cutout = self._plan.cutouts[source]
            left = self._beams.power(source, cutout) - self._interaction.own_power(source)
            past = self._sources[source].model(self._reference[source], cutout.uv)
            self._residuals[source] += left * past
            self._is_put_back[source] = True
        return self._residuals[source]

    def _seen(self, source: int, fit: GalaxyFit) -> Source:
        offset = self._plan.offset[source] + fit.offset
        return Source(fit.flux, tuple(offset), fit.ellipticity, fit.scale_length)

    def _unit_distance(
        self, unit: list[int], before: Mapping[int, GalaxyFit] | Sequence[GalaxyFit]
    ) -> float:
        """Change of the sum of a unit's models: sources that overlap may trade what the data cannot tell apart."""
        if len(unit) == 1:
            return self._distance(unit[0], before[unit[0]], self.fits[unit[0]])
        plane = self._interaction.plane(int(self._beams.nearest[unit[0]]))
        change = np.zeros(len(plane.power), np.complex64)
        for source in unit:
            place = tuple(self._place[source] - self._place[unit[0]])
            template = Template(plane.uv, self._sources[source].profile, place)
            change += template.model(self.fits[source]) - template.model(before[source])
        return math.sqrt(max(float(np.sum(plane.power * np.abs(change) ** 2)), 0.0))

    def _step_length(self, source: int, new: GalaxyFit) -> float:
        """Change of a source that takes a step, from its own block of the Fisher matrix."""
        if (old := self.fits[source]) is new:
            return 0.0
        step = difference(new, old)
        _, precision = self._sources[source].prior.pull(old)
        information = self._equations[source].information - np.diag(precision)
        return math.sqrt(max(float(step @ information @ step), 0.0))

    def _distance(self, source: int, old: GalaxyFit, new: GalaxyFit) -> float:
        if old is new:
            return 0.0
        cutout = self._plan.cutouts[source]
        power = self._beams.power(source, cutout)
        one = self._sources[source]
        change = one.model(new, cutout.uv) - one.model(old, cutout.uv)
        return float(np.sqrt(max(float(np.sum(power * np.abs(change) ** 2)), 0.0)))


def _ahead(source: ModelledSource, then: GalaxyFit, now: GalaxyFit, far: float) -> GalaxyFit:
    """Source as far beyond ``now`` as it came from ``then``, times a number."""
    if min(then.snr, now.snr) <= 0:
        return now
    return source.after(now, far * difference(now, then))


def _rms(values: Float[Array, " _"]) -> float:
    return float(np.sqrt(np.mean(values**2)))
