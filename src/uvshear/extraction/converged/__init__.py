"""All sources of a field together: major cycles over the visibilities, minor cycles over their facets in between."""

from uvshear.extraction.converged.extraction import ConvergedExtraction

__all__ = ["ConvergedExtraction"]
