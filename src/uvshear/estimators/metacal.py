"""Metacalibration: an estimator applied with a round PSF, whose response is measured by shearing the data."""

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import ClassVar, Self, TypeAlias

import numpy as np

from uvshear.estimators.estimator import Estimator, observe
from uvshear.estimators.kept_numbers import incomplete
from uvshear.estimators.mean import Mean
from uvshear.estimators.sample import Sample
from uvshear.estimators.terms import Terms
from uvshear.execution.once import KeptOnce
from uvshear.imaging.cutout import Cutout, cutout
from uvshear.interferometer.facet import Facet
from uvshear.progress import Meter
from uvshear.shapes.deconvolution import holds
from uvshear.shapes.metacal import (
    REACH,
    STEP,
    WIDEST,
    Metacalibration,
    ShearedFacets,
    scale_of,
)
from uvshear.shapes.source_facet import Column, Kept, SourceFacet
from uvshear.shapes.statistic_flag import StatisticFlag
from uvshear.typing import Array, Bool, Complex, Float

_LONGEST = REACH * WIDEST * (1 + STEP)
"""Longest baseline that a round beam may need [wavelengths]."""

_MEMORY = 0.15e9
"""Memory for the round beams that are kept [bytes]; that of a galaxy of usual size takes 10 MB, the largest 0.1 GB."""

_Measure: TypeAlias = Callable[[Facet], Float[Array, " 2"] | None]


@dataclass(frozen=True)
class Metacal(Estimator):
    """Terms of a wrapped estimator with a round PSF, with responses from differences between sheared data.

    The response is that at zero shear, which leaves an error of third order in the shear: with ``Moments`` wrapped,
    m = 0.002 at a shear of 0.03.

    Parameters
    ----------
    wrapped
        Estimator that is applied with the round PSF; the mean of ellipticities unless given.
    seed
        Seed of the noise that is added to the data.
    """

    wrapped: Estimator = field(default_factory=Mean)
    seed: int = 1
    _beams: KeptOnce["_RoundBeam"] = field(
        default_factory=lambda: KeptOnce(_MEMORY, _RoundBeam.size_of), repr=False, compare=False
    )

    name = "metacal"
    nanoseconds = 55e6
    columns: ClassVar = {
        "mc1": Column(
            "first number of the wrapped estimator with a round PSF, such as weighted e1"
        ),
        "mc2": Column(
            "second number of the wrapped estimator with a round PSF, such as weighted e2"
        ),
        "mc_r11": Column("derivative of mc1 with respect to the first component of the shear"),
        "mc_r12": Column("derivative of mc1 with respect to the second component of the shear"),
        "mc_r21": Column("derivative of mc2 with respect to the first component of the shear"),
        "mc_r22": Column("derivative of mc2 with respect to the second component of the shear"),
    }

    def statistic(self, source: SourceFacet) -> Kept | StatisticFlag:
        """Measure the source with the round PSF, once unsheared and four times with small shears."""
        facet = source.common.within(_LONGEST)
        if not facet.has_power:
            return StatisticFlag.NO_DATA
        known = self._beams.value(
            source.beam_key(_LONGEST), lambda: _RoundBeam.behind(facet, source.cells)
        )
        if not holds(known.metacalibration.radius, source.prior):
            return StatisticFlag.TOO_LARGE
        noise = source.draw_noise(self.seed)[np.hypot(*source.facet.uv.T) <= _LONGEST]

        def measure(seen: Facet) -> Float[Array, " 2"] | None:
            own = seen.in_other_unit(source.unit)
            # A cut would change the response to the shear, and the round beam costs significance.
            behind = replace(
                source, facet=own, cells=known.cells, beam=seen.power, tests_significance=False
            )
            row = observe(self.wrapped, behind)
            if row is None:
                return None
            value = self.wrapped.terms(Sample.from_rows([row]), np.zeros(1, complex)).value[0]
            return value if np.isfinite(value).all() else None

        seen = known.metacalibration.sheared_facets(facet.correlation, noise)
        found = _differences(seen, measure)
        if found is None:
            return StatisticFlag.NOT_FITTED
        value, response = found
        numbers = [*value.tolist(), *response.ravel().tolist()]
        return dict(zip(self.columns, numbers, strict=True))

    def damaged(self, sample: Sample) -> Bool[Array, " source"]:
        """Tell which sources have some numbers but not all."""
        return incomplete(sample, self.columns)

    def terms(self, sample: Sample, about: Complex[Array, " source"]) -> Terms:
        """Return the kept numbers and responses as they are."""
        kept = np.stack([np.asarray(sample[name], float) for name in self.columns], axis=-1)
        return Terms(kept[:, :2], kept[:, 2:].reshape(-1, 2, 2))

    @property
    def is_learning(self) -> bool:
        """Whether the wrapped estimator is yet to fit its population."""
        return self.wrapped.is_learning

    @property
    def learner(self) -> Estimator:
        """The wrapped estimator, or the one that this in turn wraps."""
        return self.wrapped.learner

    def trained(self, sample: Sample, about: complex, meter: Meter | None = None) -> Self:
        """Return the metacalibration of the wrapped estimator after it is trained."""
        return replace(self, wrapped=self.wrapped.trained(sample, about, meter))

    def record(self) -> dict[str, object]:
        """Return the name and the assumptions of the wrapped estimator."""
        return {"wraps": self.wrapped.name, **self.wrapped.record()}


def _differences(
    seen: ShearedFacets, measure: _Measure
) -> tuple[Float[Array, " 2"], Float[Array, "2 2"]] | None:
    """Return the value of a galaxy and its derivatives with respect to the shear; None if any measurement failed."""
    facets = [seen.unsheared, *seen.sheared[0], *seen.sheared[1]]
    found = [measure(sheared) for sheared in facets]
    measured = [numbers for numbers in found if numbers is not None]
    if len(measured) < len(facets):
        return None
    value, *moved = measured
    slopes = [(up - down) / (2 * STEP) for up, down in (moved[:2], moved[2:])]
    return value, np.stack(slopes, axis=-1)


@dataclass(frozen=True)
class _RoundBeam:
    """The round beam for facets with one size and one dirty beam.

    Parameters
    ----------
    metacalibration
        Makes the facets with the round PSF, with and without a shear.
    cells
        Cells of the facets with the round PSF.
    """

    metacalibration: Metacalibration
    cells: Cutout

    def size_of(self) -> float:
        """Return the memory that the round beam takes [bytes]."""
        return self.metacalibration.size_of()

    @classmethod
    def behind(cls, facet: Facet, cells: Cutout) -> Self:
        """Choose the round beam for facets like this one."""
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
        return cls(metacalibration, round_cells)
