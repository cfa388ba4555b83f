"""Source extraction: the sources of a field are separated and measured. Each algorithm has a folder of its own.

``field`` describes the sources that are to be measured, ``model`` the assumptions about them, and ``options`` the
method. ``extraction`` has the base class of all algorithms: ``converged`` subtracts all sources from one another until
the sky model no longer changes, and ``paper`` measures one source after the other, as Rivi & Miller 2018.
"""

from uvshear.extraction.converged import ConvergedExtraction
from uvshear.extraction.extraction import Extracted, Extraction, Setting
from uvshear.extraction.field import Field
from uvshear.extraction.model import Model
from uvshear.extraction.options import MeasurementOptions, Method
from uvshear.extraction.paper import PaperExtraction

__all__ = [
    "ConvergedExtraction",
    "Extracted",
    "Extraction",
    "Field",
    "MeasurementOptions",
    "Method",
    "Model",
    "PaperExtraction",
    "Setting",
]
