"""The base class of estimators of the shear: one class in one file, for measured and for simulated samples alike."""

from abc import ABC, abstractmethod
from collections.abc import Mapping
from typing import ClassVar, Self

import numpy as np

from uvshear.estimators.sample import Row, Sample
from uvshear.estimators.terms import Terms
from uvshear.progress import Meter
from uvshear.shapes.source_facet import Column, Kept, SourceFacet
from uvshear.shapes.statistic_flag import StatisticFlag
from uvshear.shapes.table_row import shape_values
from uvshear.typing import Array, Bool, Complex, Float


class Estimator(ABC):
    """An estimator of the shear as a ratio of sums over sources.

    The numbers that are kept for a source are computed from its facet (:meth:`statistic`); these and the table of
    shapes give the terms of the numerator and the denominator of that ratio (:meth:`terms`). A subclass should be a
    frozen dataclass. Its fields ``population``, ``fits_population``, ``position_sigma``, ``wrapped`` and ``seed``, if
    it has them, are set by the options of the commands.

    Attributes
    ----------
    name
        Name of the estimator in options and files.
    columns
        Statistics that are kept for every source besides its shape, by name; none where the shapes are enough.
    shape_columns
        Columns of the table of shapes that the terms need.
    is_expanded
        Whether the terms are expanded about a trial shear, in which case the estimate is iterated.
    nanoseconds
        Estimated work of the statistic of a source on one core [ns], for reports of the progress.
    remark
        Caveat that the command line shows with every estimate; empty if there is none.
    """

    name: ClassVar[str]
    columns: ClassVar[Mapping[str, Column]] = {}
    shape_columns: ClassVar[tuple[str, ...]] = ()
    is_expanded: ClassVar[bool] = False
    nanoseconds: ClassVar[float] = 20e6
    remark: ClassVar[str] = ""

    def statistic(self, source: SourceFacet) -> Kept | StatisticFlag | None:
        """Return the numbers of ``columns`` that are kept for a source; where it has none, the reason, or None."""
        del source
        return {}

    def numbers(self, source: SourceFacet) -> Mapping[str, object] | None:
        """Return the numbers of a simulated source that :meth:`terms` needs: its statistic, unless overridden.

        An estimator that packs its statistic for files can leave out the packing here.
        """
        found = self.statistic(source)
        return None if isinstance(found, StatisticFlag) else found

    @abstractmethod
    def terms(self, sample: Sample, about: Complex[Array, " source"]) -> Terms:
        """Return the terms of every source of a sample.

        The terms of a source must depend on that source alone, because a sample is divided into parts.

        Parameters
        ----------
        sample
            Sources with the columns ``columns`` (or :meth:`numbers`) and ``shape_columns``.
        about
            Shear at each source about which the terms are expanded, in the frame of (l, m) as the ellipticities are;
            zeros unless ``is_expanded``.

        Returns
        -------
            Terms in the frame of (l, m); NaN where a source has none.
        """

    def damaged(self, sample: Sample) -> Bool[Array, " source"]:
        """Tell which sources have kept numbers that :meth:`statistic` cannot have returned; none unless overridden."""
        return np.zeros(len(sample), bool)

    def scores(
        self, sample: Sample, about: Complex[Array, " source"]
    ) -> Float[Array, "source parameter"] | None:
        """Return the gradient of every source's log probability by the parameters of the assumed population.

        They are for a test of the population (``estimators.goodness``). An estimator that returns them has the gradient
        and the curvature of the log probability for its terms.

        Parameters
        ----------
        sample
            Sources as for :meth:`terms`.
        about
            Shear at each source, in the frame of (l, m).

        Returns
        -------
            Gradients in the order of ``goodness.PARTS``, without those of parameters that were fitted to the sample;
            NaN where a source has none. None unless the estimator assumes a population.
        """
        del sample, about
        return None

    @property
    def is_learning(self) -> bool:
        """Whether the estimator must first be trained on the sample (:meth:`trained`)."""
        return False

    @property
    def learner(self) -> "Estimator":
        """The estimator whose numbers :meth:`trained` needs: this one, or the one that it wraps."""
        return self

    def trained(self, sample: Sample, about: complex, meter: Meter | None = None) -> Self:
        """Return the estimator after it is trained on a sample.

        Parameters
        ----------
        sample
            Sources with the numbers of :attr:`learner`.
        about
            Shear of the sample, in the frame of the sky.
        meter
            Meter that counts the processed sources.
        """
        del sample, about, meter
        return self

    def record(self) -> dict[str, object]:
        """Return the assumptions of the estimator, as names and values for a JSON file."""
        return {}


def observe(estimator: Estimator, source: SourceFacet) -> Row | None:
    """Return the row of a sample for the facet of one source; None where the source cannot be measured."""
    row: Row = {"flux": source.flux}
    if set(estimator.shape_columns) - set(row):
        shape = source.shape
        if not shape.flag.is_fitted:
            return None
        row |= shape_values(shape, source.population)
    numbers = estimator.numbers(source)
    return None if numbers is None else row | dict(numbers)
