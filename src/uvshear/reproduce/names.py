"""The names of the targets and of the scales, which the command line lists without further imports."""

from types import MappingProxyType
from typing import Final

TARGETS: Final = MappingProxyType(
    {
        "psf-images": "the natural and the uniform PSF (section 4.1, figure of the PSF)",
        "psf-zenith": "ellipticity and size of the PSF against zenith distance (section 6)",
        "facet-size": "slopes with the facets of Table 1, and the numbers of cells that they need",
        "facet-residuals": "residuals with facets of fixed and of variable size (section 4.1)",
        "weighting": "shapes from averages with natural and with uniform weights (section 4.1)",
        "gridded-model": "the model averaged in cells as the data are (section 4.1)",
        "averaging": "samples of 30 kHz and 0.5 s averaged into one grid (section 2.1)",
        "shear-bias": "m and c of the mean of isolated galaxies (Table 2)",
        "shear-bias-crowded": "m and c of the mean of galaxies measured together (Table 2)",
        "c-round": "additive bias with a round PSF (sections 6 and 7)",
        "c-zenith": "additive bias against zenith distance (section 6)",
        "c-size": "additive bias against the size of galaxies (section 6)",
        "c-snapshots": "additive bias of snapshots spread over hour angles (section 6)",
        "c-facets": "additive bias with fixed and with growing facets (section 6)",
        "density": "slopes against the density of galaxies (section 4.2)",
        "shear-density": "shear without an input shear against density (section 5)",
        "metacal-round": "metacalibration with an isotropic PSF (section 5)",
        "timing": "time of a fit and use of several workers (section 4.2)",
    }
)
"""Content of each target, in the order of the page."""

QUICK: Final = "quick"
PAPER: Final = "paper"

SCALES: Final = MappingProxyType(
    {
        QUICK: "a few galaxies for each target, about a minute each on two cores",
        PAPER: "about as many galaxies as in the paper, or small enough errors; may take hours",
    }
)
"""Scales at which a target can be run."""
