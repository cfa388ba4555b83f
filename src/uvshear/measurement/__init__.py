"""The sweep over the sources: where extraction and fit meet.

``options`` says how to measure, ``field`` what there is to measure, ``sweep`` does it: facets out of the visibilities,
galaxies out of facets, and back into the sky that is subtracted.
"""

from uvshear.measurement.field import Field
from uvshear.measurement.options import MeasurementOptions
from uvshear.measurement.sweep import Progress, Sweep

__all__ = ["Field", "MeasurementOptions", "Progress", "Sweep"]
