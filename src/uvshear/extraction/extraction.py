"""The base class of extractions, with the inputs and the results of every algorithm."""

import dataclasses
from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import ClassVar

from uvshear.execution.resources import Resources
from uvshear.extraction.field import Field
from uvshear.extraction.model import Model
from uvshear.extraction.state_store import NO_STORE, StateStore
from uvshear.galaxy import Galaxies
from uvshear.interferometer.uv_range import UvRange
from uvshear.interferometer.visibilities import Observation
from uvshear.progress import Progress
from uvshear.shapes.measurement import ShapeMeasurement
from uvshear.shapes.source_facet import Kept, Statistic


@dataclass(frozen=True)
class Setting:
    """Assumptions and resources that every extraction is given besides the observation and the field.

    Parameters
    ----------
    model
        Assumptions about the sources.
    resources
        Executor and memory that may be used.
    keep
        Statistics that are to be computed for every source besides its shape.
    store
        Place for the states from which another run can go on.
    """

    model: Model = field(default_factory=Model)
    resources: Resources = field(default_factory=Resources)
    keep: tuple[Statistic, ...] = ()
    store: StateStore = NO_STORE


@dataclass(frozen=True)
class Extracted:
    """The sources of a field, each measured with the others subtracted.

    Parameters
    ----------
    measurements
        Shapes of the sources of ``Field.measured``, by index of the catalogue. Their ``snr`` is that of the baselines
        that were used; the pipeline replaces it by that of all baselines with natural weights.
    sky
        All sources of the catalogue with their fitted parameters; sources that are not in ``Field.modelled`` have no
        flux.
    uv_range
        Baselines that were used [wavelengths].
    record
        Record of the extraction, numbers and words that JSON knows, for the metadata of the shapes.
    kept
        The requested statistics, by index of the catalogue.
    """

    measurements: Mapping[int, ShapeMeasurement]
    sky: Galaxies
    uv_range: UvRange
    record: Mapping[str, object]
    kept: Mapping[int, Kept] = dataclasses.field(default_factory=dict)


class Extraction(ABC):
    """An algorithm that separates the sources of a field and measures them."""

    models_attenuation: ClassVar[bool] = False
    """Whether the models of sources include smearing and primary beams."""

    keeps_statistics: ClassVar[bool] = False
    """Whether the extraction can keep statistics for estimators of the shear."""

    def within_reach(self, field: Field) -> Field:
        """Return the field with a flag for sources that the algorithm cannot model; all can be unless overridden."""
        return field

    @abstractmethod
    def extract(
        self,
        observation: Observation,
        field: Field,
        setting: Setting,
        progress: Progress | None = None,
    ) -> Extracted:
        """Measure every source of ``field.measured``, with all other sources of ``field.modelled`` subtracted."""
