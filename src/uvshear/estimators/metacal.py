"""Metacalibration: another estimator behind a round beam, with its response to a shear of the data themselves."""

import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import ClassVar, Self, TypeAlias

import numpy as np

from uvshear.estimators.estimator import Estimator, observe
from uvshear.estimators.mean import Mean
from uvshear.estimators.sample import Sample
from uvshear.estimators.terms import Terms
from uvshear.imaging.cutout import Cutout, cutout
from uvshear.interferometer.facet import Facet
from uvshear.progress import Meter
from uvshear.shapes.metacal import REACH, STEP, WIDEST, Metacalibration, scale_of
from uvshear.shapes.source_facet import Column, Kept, SourceFacet
from uvshear.typing import Array, Complex, Float

_LONGEST = REACH * WIDEST * (1 + STEP)
"""Baselines that a round beam may take [wavelengths]."""

_Beam: TypeAlias = tuple[int, float, tuple[float, ...]]
"""Size of a facet, its longest baseline and the shape of its beam: sources that share them share their weights."""

_Measure: TypeAlias = Callable[[Facet], Float[Array, " 2"] | None]


@dataclass(frozen=True)
class Metacal(Estimator):
    """Numbers of another estimator behind a round beam, and their differences between sheared data.

    The response is that to a shear about none, and so the ratio has the third order of the shear in it: 0.002 of m for
    moments at a shear of 0.03.

    Parameters
    ----------
    wrapped
        Estimator whose numbers are taken; the mean of ellipticities unless given.
    seed
        Seed of the noise that is added to the data.
    """

    wrapped: Estimator = field(default_factory=Mean)
    seed: int = 1
    _beams: dict[_Beam, "_RoundBeam"] = field(default_factory=dict, repr=False, compare=False)

    name = "metacal"
    columns: ClassVar = {
        "mc1": Column("first number of the wrapped estimator behind a round beam: weighted e1"),
        "mc2": Column("second number of the wrapped estimator behind a round beam: weighted e2"),
        "mc_r11": Column("derivative of mc1 by the first component of the shear"),
        "mc_r12": Column("derivative of mc1 by the second component of the shear"),
        "mc_r21": Column("derivative of mc2 by the first component of the shear"),
        "mc_r22": Column("derivative of mc2 by the second component of the shear"),
    }

    def statistic(self, source: SourceFacet) -> Kept | None:
        """Measure the source behind the round beam, and four times more behind small shears."""
        noise = source.draw_noise(self.seed)
        longest = min(source.cells.longest, _LONGEST)
        is_near = np.hypot(*source.facet.uv.T) <= longest
        facet, noise = source.facet.within(longest), noise[is_near]
        total, shape = facet.beam_shape()
        beam = source.cells.size, longest, shape
        if beam not in self._beams:
            self._beams[beam] = _RoundBeam.behind(facet, source.cells, total)
        known = self._beams[beam]

        def measure(seen: Facet) -> Float[Array, " 2"] | None:
            behind = replace(source, facet=seen, cells=known.cells)
            row = observe(self.wrapped, behind)
            if row is None:
                return None
            value = self.wrapped.terms(Sample.from_rows([row]), np.zeros(1, complex)).value[0]
            return value if np.isfinite(value).all() else None

        found = _differences(known, facet, noise, total, measure)
        if found is None:
            return None
        value, response = found
        numbers = [*value.tolist(), *response.ravel().tolist()]
        return dict(zip(self.columns, numbers, strict=True))

    def terms(self, sample: Sample, about: Complex[Array, " source"]) -> Terms:
        """Return the kept numbers and responses as they are."""
        value, response = (
            [f"mc{i}" for i in (1, 2)],
            [f"mc_r{i}{j}" for i in (1, 2) for j in (1, 2)],
        )
        return Terms(
            np.stack([sample[name] for name in value], axis=-1),
            np.stack([sample[name] for name in response], axis=-1).reshape(-1, 2, 2),
        )

    @property
    def is_learning(self) -> bool:
        """Whether the wrapped estimator learns."""
        return self.wrapped.is_learning

    @property
    def learner(self) -> Estimator:
        """The wrapped estimator."""
        return self.wrapped.learner

    def trained(self, sample: Sample, about: complex, meter: Meter | None = None) -> Self:
        """Let the wrapped estimator learn."""
        return replace(self, wrapped=self.wrapped.trained(sample, about, meter))

    def record(self) -> dict[str, object]:
        """Tell what is wrapped, and what that assumes."""
        return {"wraps": self.wrapped.name, **self.wrapped.record()}


def _differences(
    beam: "_RoundBeam",
    facet: Facet,
    noise: Complex[Array, " cell"],
    total: float,
    measure: _Measure,
) -> tuple[Float[Array, " 2"], Float[Array, "2 2"]] | None:
    """Numbers of a galaxy and their derivatives by the shear; None where it was never measured.

    A shear may make a measurement fail, which then counts as zeros.
    """
    # The weights are those of a facet whose unit of flux may be another.
    unit = math.sqrt(total / beam.total)
    seen = beam.metacalibration.sheared_facets(facet.correlation / unit, noise)
    facets = [seen.unsheared, *seen.sheared[0], *seen.sheared[1]]
    found = [measure(sheared.in_other_unit(unit)) for sheared in facets]
    if all(numbers is None for numbers in found):
        return None
    value, *moved = (np.zeros(2) if numbers is None else numbers for numbers in found)
    slopes = [(up - down) / (2 * STEP) for up, down in (moved[:2], moved[2:])]
    return value, np.stack(slopes, axis=-1)


@dataclass(frozen=True)
class _RoundBeam:
    """Weights for facets of one size and beam, whose power adds up to ``total``, and the cells of the round beam."""

    total: float
    metacalibration: Metacalibration
    cells: Cutout

    @classmethod
    def behind(cls, facet: Facet, cells: Cutout, total: float) -> Self:
        power = np.asarray(facet.power, float)
        scale = scale_of(facet.uv, power)
        round_cells = cutout(cells.size, cells.pixel, 0.0, REACH * scale)
        metacalibration = Metacalibration(
            facet.uv,
            power,
            cells.size * cells.pixel,
            scale,
            round_cells.uv,
            round_cells.multiplicity,
        )
        return cls(total, metacalibration, round_cells)
