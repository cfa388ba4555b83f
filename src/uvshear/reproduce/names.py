"""The names of the targets and of the scales, which the command line lists without further imports."""

from types import MappingProxyType
from typing import Final

TARGETS: Final = MappingProxyType(
    {
        "psf-images": "the natural and the uniform PSF (section 4.1, figure of the PSF)",
        "psf-zenith": "ellipticity and size of the PSF against zenith distance (section 6)",
        "facet-size": "slopes with the facets of Table 1, and the numbers of cells that they need",
    }
)
"""Content of each target, in the order of the page."""

QUICK: Final = "quick"
PAPER: Final = "paper"

SCALES: Final = MappingProxyType(
    {
        QUICK: "a few galaxies for each target, about a minute each on two cores",
        PAPER: "the numbers of galaxies of the paper, which may take hours",
    }
)
"""Scales at which a target can be run."""
