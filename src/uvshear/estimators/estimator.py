"""What an estimator of the shear is: one class in one file, for measured and for simulated samples alike."""

from abc import ABC, abstractmethod
from collections.abc import Mapping
from typing import ClassVar, Self

from uvshear.estimators.sample import Sample
from uvshear.estimators.terms import Terms
from uvshear.estimators.uncertainty import Jackknife, Uncertainty
from uvshear.progress import Meter
from uvshear.shapes.measurement import FitFlag
from uvshear.shapes.source_facet import Column, Kept, SourceFacet
from uvshear.shapes.table_row import shape_values
from uvshear.typing import Array, Complex


class Estimator(ABC):
    """An estimator of the shear as a ratio of sums over sources.

    From the facet of a source it takes the numbers that are kept (:meth:`statistic`), and from these, and from the
    table of shapes, the terms of the two sums (:meth:`terms`). A subclass is best a frozen dataclass: fields called
    ``population``, ``position_sigma``, ``wrapped`` or ``seed`` are set by the options of the commands that have them.

    Attributes
    ----------
    name
        The name by which options and files know the estimator.
    columns
        Statistics that are kept of every source beside its shape, by name; none where the shapes are enough.
    shape_columns
        Columns of the table of shapes that the terms are made of.
    is_expanded
        Whether the terms are an expansion about a shear: the ratio is then iterated.
    is_learning
        Whether something is learnt from the sample first (:meth:`trained`).
    remark
        What a user must know of the estimates, in one line for the terminal; empty if there is nothing.
    """

    name: ClassVar[str]
    columns: ClassVar[Mapping[str, Column]] = {}
    shape_columns: ClassVar[tuple[str, ...]] = ()
    is_expanded: ClassVar[bool] = False
    remark: ClassVar[str] = ""

    def statistic(self, source: SourceFacet) -> Kept | None:
        """Work out the kept numbers of a source from its facet; None where the source has none."""
        del source
        return {}

    @abstractmethod
    def terms(self, sample: Sample, about: Complex[Array, " source"]) -> Terms:
        """Work out the terms of every source of a sample.

        The terms of a source depend on that source alone, since a sample may be worked on in parts.

        Parameters
        ----------
        sample
            Sources with the columns ``columns`` and ``shape_columns``.
        about
            Shear at each source about which the terms are expanded, in the frame of (l, m) as the ellipticities are.

        Returns
        -------
            Terms in the frame of (l, m); NaN where a source has none.
        """

    @property
    def is_learning(self) -> bool:
        """Whether something is learnt from the sample first."""
        return False

    @property
    def learner(self) -> "Estimator":
        """The estimator whose columns a sample needs for :meth:`trained`."""
        return self

    def trained(self, sample: Sample, about: complex, meter: Meter | None = None) -> Self:
        """Return the estimator with what it learns from a sample.

        Parameters
        ----------
        about
            Shear that the sample is behind, in the frame of the sky.
        meter
            Hears of every source that was worked on.
        """
        del sample, about, meter
        return self

    @property
    def uncertainty(self) -> Uncertainty:
        """The way in which standard errors are found."""
        return Jackknife()

    def record(self) -> dict[str, object]:
        """Return what the estimator assumes, for files: names and values that JSON knows."""
        return {}


def observe(estimator: Estimator, source: SourceFacet) -> dict[str, float | Array] | None:
    """Row of a sample from the facet of one source; None where the source cannot be measured."""
    row: dict[str, float | Array] = {"flux": source.flux}
    if set(estimator.shape_columns) - set(row):
        shape = source.shape
        if shape.flag is not FitFlag.OK:
            return None
        row |= shape_values(shape, source.population)
    kept = estimator.statistic(source)
    if kept is None:
        return None
    return row | dict(kept)
