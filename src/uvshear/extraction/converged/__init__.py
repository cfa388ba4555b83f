"""All sources of a field together: major cycles over the visibilities, and minor cycles on their facets."""

from uvshear.extraction.converged.extraction import ConvergedExtraction

__all__ = ["ConvergedExtraction"]
