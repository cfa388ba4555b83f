"""Source extraction: the sources of a field told apart and measured, by one algorithm a folder.

``field`` is what there is to measure, ``model`` what is believed of it, ``options`` how it is measured. ``extraction``
is the protocol that every algorithm follows: ``converged`` subtracts all sources from one another until their sky no
longer changes, ``paper`` takes one source after the other, as Rivi & Miller 2018.
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
