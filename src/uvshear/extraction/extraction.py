"""The protocol of source extraction: what every algorithm takes and gives."""

import dataclasses
from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import ClassVar

from uvshear.execution.resources import Resources
from uvshear.extraction.field import Field
from uvshear.extraction.model import Model
from uvshear.galaxy import Galaxies
from uvshear.interferometer.uv_range import UvRange
from uvshear.interferometer.visibilities import Observation
from uvshear.progress import Progress
from uvshear.shapes.measurement import ShapeMeasurement
from uvshear.shapes.source_facet import Kept, Statistic


@dataclass(frozen=True)
class Setting:
    """What every extraction is given besides the observation and the field.

    Parameters
    ----------
    model
        What is believed of the sources.
    resources
        What may be used.
    keep
        Statistics that are wanted of every source beside its shape.
    """

    model: Model = field(default_factory=Model)
    resources: Resources = field(default_factory=Resources)
    keep: tuple[Statistic, ...] = ()


@dataclass(frozen=True)
class Extracted:
    """The sources of a field, each measured without the others.

    Parameters
    ----------
    measurements
        By index of the catalogue, those of ``Field.measured``. Their ``snr`` is that of the baselines that took part;
        the pipeline quotes that of natural weights.
    sky
        All sources of the catalogue as they were found; sources that are not in ``Field.modelled`` have no flux.
    uv_range
        Baselines that took part [wavelengths].
    record
        How the extraction went: numbers and words that JSON knows, for the metadata of the shapes.
    kept
        The statistics that were wanted, by index of the catalogue.
    """

    measurements: Mapping[int, ShapeMeasurement]
    sky: Galaxies
    uv_range: UvRange
    record: Mapping[str, object]
    kept: Mapping[int, Kept] = dataclasses.field(default_factory=dict)


class Extraction(ABC):
    """An algorithm that tells the sources of a field apart and measures them."""

    models_attenuation: ClassVar[bool] = False
    """Whether sources are modelled as averaging and primary beams leave them."""

    keeps_statistics: ClassVar[bool] = False
    """Whether it keeps statistics for estimators of the shear."""

    @abstractmethod
    def extract(
        self,
        observation: Observation,
        field: Field,
        setting: Setting,
        progress: Progress | None = None,
    ) -> Extracted:
        """Measure every source of ``field.measured``, with all other sources of ``field.modelled`` subtracted."""
