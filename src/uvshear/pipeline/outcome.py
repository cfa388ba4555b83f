"""The outcome of a measurement in words: how many sources have which flag, and why none was measured."""

import math

import numpy as np
from astropy.table import Table

from uvshear.errors import InputError
from uvshear.geometry.directions import PhaseCentre, direction_cosines
from uvshear.io.catalogue import Catalogue
from uvshear.shapes.measurement import FitFlag

GONE = frozenset({FitFlag.OUTSIDE_FIELD, FitFlag.BELOW_HORIZON})


def tally(shapes: Table) -> str:
    """Return the number of sources that were measured, and the numbers of the others by flag."""
    flags = np.asarray(shapes["flag"]).astype(str)
    words, counts = np.unique(flags[flags != FitFlag.OK.word], return_counts=True)
    order = np.argsort(-counts, kind="stable")
    others = ", ".join(f"{counts[k]} {words[k]}" for k in order)
    measured = int(np.count_nonzero(flags == FitFlag.OK.word))
    return f"{measured} of {len(flags)} sources measured" + (f"; {others}" if others else "")


def check_field(sources: Catalogue, phase_centre: PhaseCentre, flags: np.ndarray) -> None:
    """Refuse a catalogue of which no source is in the field, and say how far away the nearest is.

    Parameters
    ----------
    sources
        The catalogue.
    phase_centre
        Phase centre of the observation.
    flags
        Flag of each source before the measurement.
    """
    if len(sources) == 0 or not all(flag in GONE for flag in flags):
        return
    nearest = _nearest(sources, phase_centre)
    hint = ""
    if sources.ra is not None and sources.dec is not None and sources.ra.max() <= math.radians(24):
        as_hours = direction_cosines(phase_centre, 15 * sources.ra, sources.dec)
        if np.any((as_hours[2] > 0) & (np.hypot(*as_hours[:2]) < 0.5 * math.sin(nearest))):
            hint = "; the right ascensions seem to be in hours, and degrees are needed"
    raise InputError(
        f"no source of the catalogue is in the field: the nearest is {math.degrees(nearest):.3g} degrees from the"
        f" phase centre (RA {math.degrees(phase_centre.ra):.5g}, Dec {math.degrees(phase_centre.dec):.5g} deg), which"
        f" is too far, or smearing and the primary beam leave almost none of its flux{hint}"
    )


def _nearest(sources: Catalogue, phase_centre: PhaseCentre) -> float:
    l, m, n = sources.directions(phase_centre)
    return float(np.arctan2(np.hypot(l, m), n).min())


def why_none_was_measured(shapes: Table) -> str | None:
    """Return the likely cause if no galaxy was measured; None if one was, or if the catalogue has points alone."""
    flags = np.asarray(shapes["flag"]).astype(str)
    is_galaxy = flags != FitFlag.POINT_SOURCE.word
    if not is_galaxy.any() or np.any(flags == FitFlag.OK.word):
        return None
    word = max(set(flags[is_galaxy]), key=list(flags[is_galaxy]).count)
    flag = next(flag for flag in FitFlag if flag.word == word)
    return f"the most frequent flag is {word} ({flag.value})"
