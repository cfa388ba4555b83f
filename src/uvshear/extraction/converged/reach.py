"""Sources that images in (l, m) do not represent: too far from the phase centre, or too large."""

import math

import numpy as np

from uvshear.extraction.field import Field
from uvshear.imaging.bands import OVERSAMPLING, longest_seen, steepest
from uvshear.imaging.curvature import half_width_within
from uvshear.shapes.measurement import FitFlag
from uvshear.typing import Array, Bool, Float

MOST_STRETCHED = 1.5
"""Largest ratio of a baseline, as a source sees it, to the longest one that is used. The cost of a major cycle grows
with its square."""

NEGLIGIBLE = 1.02
"""Ratio up to which pixels are not made finer: the taper of a model's transform then loses less than 1e-4."""

STAMP = 2
"""Distance around a source in pixels, up to which the curvature of n must be that of its tile. Errors of the prediction
are then below 5e-4; with half of this distance they reach 4e-3."""

WIDEST_IMAGE = 8192
"""Largest width of the image of a source [finest pixels]: 256 MB."""


def used_baselines(field: Field, longest: float) -> Float[Array, "sample 3"]:
    """Return those baselines of the field's probes that are used [wavelengths]."""
    probes = field.summary.probes
    distance = probes.uv_distance
    taken = (distance >= field.uv_range.minimum) & (distance < longest)
    return probes.uvw[taken].astype(float)


def stretch(uvw: Float[Array, "sample 3"], slope: float, longest: float) -> float:
    """Ratio of the longest baseline that sources up to a slope of n see, to the longest that is used; at least 1."""
    return max(float(longest_seen(uvw, slope).max(initial=0.0)) / longest, 1.0)


def out_of_reach(field: Field, longest: float) -> Bool[Array, " source"]:
    """Tell which modelled sources are too far from the phase centre for baselines up to this length [wavelengths].

    Near the horizon of the phase centre a small step in (l, m) is a large one on the sky. If the array has w, the
    baselines as a source there sees them exceed what the pixels can represent, or w (n - 1) bends within a few pixels.
    """
    uvw = used_baselines(field, longest)
    w = float(np.sqrt(np.mean(uvw[:, 2] ** 2))) if len(uvw) else 0.0
    needed = STAMP / (2 * OVERSAMPLING * longest)
    far = []
    for l, m in zip(field.l[field.modelled], field.m[field.modelled], strict=True):
        slope = steepest(np.array([l]), np.array([m]))
        is_stretched = stretch(uvw, slope, longest) > MOST_STRETCHED
        far.append(is_stretched or half_width_within(math.hypot(l, m), w) < needed)
    return np.array(far, bool)


def too_large(field: Field, longest: float, scale_lengths: float) -> Bool[Array, " source"]:
    """Tell which modelled sources are too large to be drawn to this number of scale lengths.

    Parameters
    ----------
    field
        The field.
    longest
        Longest baseline that is used [wavelengths].
    scale_lengths
        Width of the image of a source over the median of the prior on its scale length.
    """
    width = scale_lengths * np.exp(field.size.log_median[field.modelled])
    is_galaxy = field.flags[field.modelled] == FitFlag.OK
    return is_galaxy & (width * 2 * OVERSAMPLING * longest > WIDEST_IMAGE)
