"""Figures: the only part of the package that imports matplotlib.

Each ``draw_`` function returns a figure, which ``save`` writes.
"""

from uvshear.plot import backend  # noqa: F401 - before the others, which import matplotlib
from uvshear.plot.ellipticities import draw_ellipticities
from uvshear.plot.figure import check_picture, save
from uvshear.plot.layout import draw_layout
from uvshear.plot.psf import draw_psf
from uvshear.plot.residual_image import draw_residual_image
from uvshear.plot.residuals import draw_residuals
from uvshear.plot.shear import draw_shear
from uvshear.plot.uv_coverage import draw_uv_coverage

__all__ = [
    "check_picture",
    "draw_ellipticities",
    "draw_layout",
    "draw_psf",
    "draw_residual_image",
    "draw_residuals",
    "draw_shear",
    "draw_uv_coverage",
    "save",
]
