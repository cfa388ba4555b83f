"""How sources are told apart: what every way of doing it takes and gives."""

import dataclasses
from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar

from uvshear.extraction.facets import UvRange
from uvshear.fit.measurement import ShapeMeasurement
from uvshear.galaxy import Galaxies
from uvshear.interferometer.visibilities import Observation
from uvshear.measurement.field import Field
from uvshear.progress import Progress
from uvshear.typing import Array

if TYPE_CHECKING:  # the options hold an extraction
    from uvshear.measurement.options import MeasurementOptions


@dataclass(frozen=True)
class Extracted:
    """The sources of a field, each measured without the others.

    Parameters
    ----------
    measurements
        By index of the catalogue; those of ``Field.measured``. Their ``snr`` is that of the baselines that took part:
        ``pipeline.extract`` quotes natural weights.
    sky
        All sources of the catalogue as they were found; those that are not in ``Field.modelled`` without flux.
    uv_range
        Baselines that took part [wavelengths].
    record
        How it went: numbers and words that JSON knows, written into the metadata of the shapes.
    kept
        Statistics asked for, by index of the catalogue.
    """

    measurements: Mapping[int, ShapeMeasurement]
    sky: Galaxies
    uv_range: UvRange
    record: Mapping[str, object]
    kept: Mapping[int, Mapping[str, float | Array]] = dataclasses.field(default_factory=dict)


class Extraction(ABC):
    """A way of telling sources apart."""

    models_losses: ClassVar[bool] = False
    """Whether sources are modelled as averaging and primary beams leave them."""

    @abstractmethod
    def measure(
        self,
        observation: Observation,
        field: Field,
        options: "MeasurementOptions",
        progress: Progress | None,
    ) -> Extracted:
        """Measure every source of ``field.measured``, what is around it taken away."""
