"""Options of a measurement: its assumptions, its method, its resources, and the statistics that are kept."""

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
    """The algorithm of a measurement and its settings; every alternative is an object.

    Parameters
    ----------
    extraction
        The algorithm that separates sources, with its tolerances; ``ConvergedExtraction`` unless given.
    uv_range
        Baselines that are used for the shapes.
    weightings
        Weightings that are applied to the natural weights one after the other (``interferometer.weighting``), which
        costs information. Errors of e remain correct for galaxies of every size; errors of fluxes do not
        (``extraction.weighted_shapes``).
    field_radius
        Radius of the field about the phase centre [rad]; sources outside it are flagged and not measured.
    """

    extraction: Extraction = field(default_factory=ConvergedExtraction)
    uv_range: UvRange = field(default_factory=UvRange)
    weightings: tuple[Weighting, ...] = ()
    field_radius: float = np.radians(5.0)


@dataclass(frozen=True)
class MeasurementOptions:
    """Options for the measurement of the sources of a catalogue.

    Parameters
    ----------
    model
        Assumptions about the galaxies and the dishes.
    method
        Algorithm and its settings.
    resources
        Executor and memory that may be used.
    keep
        Statistics that are kept for every source besides its shape, for estimators of the shear.
    """

    model: Model = field(default_factory=Model)
    method: Method = field(default_factory=Method)
    resources: Resources = field(default_factory=Resources)
    keep: Sequence[Statistic] = ()

    def __post_init__(self) -> None:
        kept = [statistic for statistic in self.keep if statistic.columns]
        if kept and self.method.weightings:
            raise InputError(
                "statistics for estimators of the shear (--keep, keep=) assume the noise of natural weights;"
                " another weighting cannot be combined with them"
            )
        if kept and not self.method.extraction.keeps_statistics:
            raise InputError(
                f"{type(self.method.extraction).__name__} keeps no statistics for estimators of the shear (--keep,"
                " keep=); ConvergedExtraction does"
            )

    @property
    def setting(self) -> Setting:
        """The part of the options that every extraction is given, whatever its method."""
        return Setting(self.model, self.resources, tuple(self.keep))
