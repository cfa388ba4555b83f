"""Geometry of the sky, independent of telescopes and galaxies.

``directions`` converts right ascension and declination to direction cosines and back; ``ellipticity`` holds the effects
of shear, rotation and a change of axes on an ellipse. Everything here is a pure function of arrays; docs/conventions.md
has the conventions.
"""

from uvshear.geometry.directions import (
    PhaseCentre,
    direction_cosines,
    equatorial,
    local_north,
    n_minus_one,
    separation,
)
from uvshear.geometry.ellipticity import (
    add_shear,
    lensing_components,
    position_angle,
    quadratic_form,
    quadratic_form_derivatives,
    quadratic_form_of,
    rotate,
    sheared_scale_length,
    to_field_frame,
    to_local_north,
)

__all__ = [
    "PhaseCentre",
    "add_shear",
    "direction_cosines",
    "equatorial",
    "lensing_components",
    "local_north",
    "n_minus_one",
    "position_angle",
    "quadratic_form",
    "quadratic_form_derivatives",
    "quadratic_form_of",
    "rotate",
    "separation",
    "sheared_scale_length",
    "to_field_frame",
    "to_local_north",
]
