"""Extractions by name: those of the package, those of installed packages, and those of a user's own file."""

from typing import Any, Final

from uvshear.errors import InputError
from uvshear.extraction.extraction import Extraction
from uvshear.plugins import Registry

EXTRACTIONS: Final = Registry(
    "extraction",
    "uvshear.extractions",
    {
        "converged": "uvshear.extraction.converged:ConvergedExtraction",
        "paper": "uvshear.extraction.paper:PaperExtraction",
    },
    {},
)
"""Every registered object is an :class:`Extraction`, or a class or function that returns one without an argument."""


def extraction_named(name: str) -> Extraction:
    """Return the extraction of a registered name, or of ``MODULE:NAME``."""
    found: Any = EXTRACTIONS.find(name)
    extraction = found() if callable(found) and not isinstance(found, Extraction) else found
    if not isinstance(extraction, Extraction):
        raise InputError(
            f"the extraction '{name}' is not an Extraction but has the type {type(extraction).__name__}"
        )
    return extraction
