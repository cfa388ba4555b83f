"""The measurement of the sources of a field: where extraction and fit meet.

``field`` is what there is to measure, ``options`` how. ``extraction`` is what every way of telling sources apart has in
common, and each way is one module: ``converged`` over ``settlement``, ``joint`` and ``groups``; ``paper`` (Rivi &
Miller 2018) over the ``sweep``.
"""

from uvshear.measurement.converged import ConvergedExtraction
from uvshear.measurement.extraction import Extracted, Extraction
from uvshear.measurement.field import Field
from uvshear.measurement.options import MeasurementOptions
from uvshear.measurement.paper import PaperExtraction

__all__ = [
    "ConvergedExtraction",
    "Extracted",
    "Extraction",
    "Field",
    "MeasurementOptions",
    "PaperExtraction",
]
