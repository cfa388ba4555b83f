"""How to measure: what is believed, by which method, with which resources, and what is kept."""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from uvshear.errors import InputError
from uvshear.execution.resources import Resources
from uvshear.extraction.converged import ConvergedExtraction
from uvshear.extraction.extraction import Extraction, Setting
from uvshear.extraction.model import Model
from uvshear.interferometer.uv_range import UvRange
from uvshear.interferometer.weighting import Weighting
from uvshear.shapes.source_facet import Statistic


@dataclass(frozen=True)
class Method:
    """How shapes are measured; every alternative is an object.

    Parameters
    ----------
    extraction
        The algorithm that tells sources apart, with its tolerances; ``ConvergedExtraction`` unless given.
    uv_range
        Baselines that take part in the shapes.
    weightings
        Applied to the natural weights one after the other (``interferometer.weighting``), which costs information.
        Errors of e stay right for galaxies of every size, errors of fluxes do not (``extraction.weighted_shapes``).
    field_radius
        Sources farther from the phase centre are flagged and left alone [rad].
    """

    extraction: Extraction = field(default_factory=ConvergedExtraction)
    uv_range: UvRange = field(default_factory=UvRange)
    weightings: tuple[Weighting, ...] = ()
    field_radius: float = np.radians(5.0)


@dataclass(frozen=True)
class MeasurementOptions:
    """How to measure the sources of a catalogue.

    Parameters
    ----------
    model
        What is believed.
    method
        How it is done.
    resources
        What may be used.
    keep
        Statistics that are kept of every source beside its shape, for estimators of the shear.
    """

    model: Model = field(default_factory=Model)
    method: Method = field(default_factory=Method)
    resources: Resources = field(default_factory=Resources)
    keep: Sequence[Statistic] = ()

    def __post_init__(self) -> None:
        kept = [statistic for statistic in self.keep if statistic.columns]
        if kept and self.method.weightings:
            raise InputError(
                "statistics for estimators of the shear (--keep) take the noise for that of natural weights;"
                " another weighting cannot be combined with them"
            )
        if kept and not self.method.extraction.keeps_statistics:
            raise InputError(
                f"{type(self.method.extraction).__name__} keeps no statistics for estimators of the shear (--keep);"
                " ConvergedExtraction does"
            )

    @property
    def setting(self) -> Setting:
        """What every extraction is given, whatever its own method."""
        return Setting(self.model, self.resources, tuple(self.keep))
