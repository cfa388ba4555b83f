"""The quantities of a catalogue, each read from its columns, checked, in SI and radians."""

import math
from collections.abc import Mapping, Sequence
from typing import Any, Final

import numpy as np
from astropy import units
from astropy.table import Table

from uvshear.constants import RADIO_FREQUENCIES, REFERENCE_FREQUENCY
from uvshear.errors import InputError
from uvshear.galaxy.registry import PROFILES
from uvshear.geometry.directions import PhaseCentre
from uvshear.io.aegean import Aegean
from uvshear.io.column_map import found_names
from uvshear.io.columns import Columns, NamedColumn, shown
from uvshear.io.frames import EquatorialFrame, frame_of_metadata
from uvshear.io.identifiers import identifiers_among
from uvshear.io.pybdsf import PyBDSF
from uvshear.io.source_finders import Sizes, SourceFinder
from uvshear.io.votables import COORDINATE_SYSTEM
from uvshear.typing import Array, Bool, Complex, Float

SOURCE_FINDERS: tuple[SourceFinder, ...] = (PyBDSF(), Aegean())

REFERENCE_FREQUENCY_KEYS = ("reference_frequency", "reffreq", "freq0")
"""Keys of the metadata that state the frequency of the fluxes; the last is PyBDSF's."""

POINT = "point"
GALAXY = "galaxy"
"""Words of the column ``profile``. An empty cell or the name of any known profile stands for a galaxy as well; the
profile of the model is an option of the measurement."""

LARGEST: Final = 1.0
"""Scale length that no source has, and error of a position that is no error [rad]."""


def finder_of(names: Sequence[str]) -> SourceFinder | None:
    """Return the source finder that writes tables with these columns, if there is one."""
    return next((finder for finder in SOURCE_FINDERS if finder.wrote(names)), None)


def columns_of(table: Table, name: str, column_map: Mapping[str, str]) -> Columns:
    """Return the columns of a table: those of a source finder under our names, then those of the map."""
    sources: Mapping[str, NamedColumn] = {}
    facts: Mapping[str, Any] = {}
    if (finder := finder_of(table.colnames)) is not None:
        sources, facts = finder.sources(table), finder.metadata(table)
    if "id" not in sources and (other := identifiers_among(table.colnames)) is not None:
        sources = {**sources, "id": NamedColumn(other)}
    mapped = found_names(column_map, tuple(table.colnames), name)
    sources = {**sources, **{ours: NamedColumn(theirs) for ours, theirs in mapped.items()}}
    return Columns(table, name, sources, facts)


def has_positions_and_fluxes(names: Sequence[str], column_map: Mapping[str, str]) -> bool:
    """Tell whether a table with these columns can be a catalogue."""
    lower = {name.lower() for name in names}
    known = lower | {ours for ours, theirs in column_map.items() if theirs.lower() in lower}
    is_plain = "flux" in known and ({"ra", "dec"} <= known or {"l", "m"} <= known)
    return is_plain or finder_of(names) is not None


def positions(columns: Columns) -> dict[str, Float[Array, " source"]]:
    """Read (ra, dec) where the table has them, else (l, m)."""
    pairs = (("ra", "dec"), ("l", "m"))
    there = [[columns.has(name) for name in pair] for pair in pairs]
    if not any(map(all, there)):
        for pair, known in zip(pairs, there, strict=True):
            if any(known):
                absent, present = pair[known.index(False)], pair[known.index(True)]
                raise InputError(f"{columns.name}: has no column '{absent}' to go with '{present}'")
        raise InputError(
            f"{columns.name}: has no positions; columns 'ra' and 'dec' (deg), or 'l' and 'm' (rad),"
            f" are needed (it has {', '.join(columns.names)}); --column-map ra=NAME,dec=NAME (column_map=) names them"
        )
    if all(there[0]):
        ra = columns.number("ra", units.rad, assumed=units.deg)
        dec = columns.number("dec", units.rad, assumed=units.deg)
        turns = np.abs(ra) <= 2 * math.pi * (1 + 1e-9)
        columns.require("ra", turns, "-360 to 360 degrees is needed", np.degrees(ra))
        within = np.abs(dec) <= math.pi / 2
        columns.require("dec", within, "-90 to 90 degrees is needed", np.degrees(dec))
        ra, dec = frame_of(columns).to_icrs(ra, dec)
        return {"ra": ra, "dec": dec}
    l = columns.number("l", units.rad, assumed=units.rad)
    m = columns.number("m", units.rad, assumed=units.rad)
    radius = np.hypot(l, m)
    columns.require("l, m", radius < 1, "l^2 + m^2 < 1 is needed (radians)", radius)
    return {"l": l, "m": m}


def frame_of(columns: Columns) -> EquatorialFrame:
    """Return the frame that the column ``ra``, the metadata, or the column's name states; ICRS if none does."""
    try:
        stated = columns.metadata_of("ra").get(COORDINATE_SYSTEM)
        frame = (
            frame_of_metadata(columns.metadata)
            if stated is None
            else EquatorialFrame.stated(*stated)
        )
    except InputError as error:
        raise InputError(f"{columns.name}: {error}") from error
    if frame == EquatorialFrame() and "B1950" in columns.source("ra").upper():
        frame = EquatorialFrame("FK4", 1950.0)
    if not frame.is_icrs and columns.has("shear1"):
        raise InputError(
            f"{columns.name}: its positions are {frame.name}, and its shears would be in that frame; give both in ICRS"
        )
    return frame


def sizes(columns: Columns) -> Sizes | None:
    """Return the scale lengths of the column, else those of a source finder; None if the table has neither."""
    if not columns.has("scale_length"):
        finder = finder_of(columns.names)
        return None if finder is None else finder.sizes(columns)
    scale_length = columns.known("scale_length", units.rad, assumed=units.arcsec)
    unknown = np.isnan(scale_length)
    columns.require(
        "scale_length", unknown | (scale_length >= 0), "a size >= 0 is needed", scale_length
    )
    fits = unknown | (scale_length < LARGEST)
    columns.require("scale_length", fits, "a size below 1 rad is needed", scale_length)
    err = np.zeros_like(scale_length)
    if columns.has("scale_length_err"):
        err = columns.error("scale_length_err", units.rad, assumed=units.arcsec)
    return Sizes(scale_length, err)


def spin_2(
    columns: Columns, first: str, second: str, needed: str
) -> Complex[Array, " source"] | None:
    """Return both components as a complex number below 1 in modulus, if the table has them."""
    if not (columns.has(first) or columns.has(second)):
        return None
    if not (columns.has(first) and columns.has(second)):
        absent = first if columns.has(second) else second
        raise InputError(
            f"{columns.name}: has no column '{absent}'; give both {first} and {second}, or neither"
        )
    real, imaginary = (
        columns.number(name, units.dimensionless_unscaled) for name in (first, second)
    )
    value = real + 1j * imaginary
    columns.require(f"{first}, {second}", np.abs(value) < 1, needed, value)
    return value


def position_errors(columns: Columns) -> Float[Array, " source"] | None:
    """Root of the mean of both axes' variances, if both have errors; an absurd one counts as not known."""
    if not (columns.has("ra_err") and columns.has("dec_err")):
        return None
    ra, dec = (columns.error(name, units.rad, assumed=units.deg) for name in ("ra_err", "dec_err"))
    # Fits that fail have errors of 1e6 degrees (https://github.com/lofar-astron/PyBDSF/issues/31).
    err = np.hypot(ra, dec) / math.sqrt(2)
    return np.where(err < LARGEST, err, 0.0)


def points(columns: Columns) -> Bool[Array, " source"] | None:
    """Tell which sources the column ``profile`` calls points; all others are galaxies."""
    if not columns.has("profile"):
        return None
    words = columns.words("profile")
    galaxies = (GALAXY, *PROFILES.names())
    known = np.isin(words, [POINT, "", *galaxies])
    if not known.all():
        raise InputError(
            f"{columns.name}: column '{columns.source('profile')}' has '{shown(words[~known][0])}';"
            f" '{POINT}' or one of {', '.join(repr(word) for word in galaxies)} is needed"
        )
    return words == POINT


def field_centre(columns: Columns) -> PhaseCentre | None:
    """Return the direction of l = m = 0 of a simulated catalogue, if its metadata have it."""
    metadata = columns.metadata
    try:
        return PhaseCentre(math.radians(metadata["ra0_deg"]), math.radians(metadata["dec0_deg"]))
    except (KeyError, TypeError):
        return None


def frequencies(columns: Columns, option: float | None) -> Float[Array, " source"]:
    """Frequency of each flux: from the option, else the column, else the metadata, else 1.4 GHz."""
    frequency = np.full(len(columns.identifier), REFERENCE_FREQUENCY)
    if option is not None:
        frequency[:] = option
    elif columns.has("reference_frequency"):
        frequency = columns.number("reference_frequency", units.Hz, assumed=units.Hz)
    else:
        metadata = columns.metadata
        stated = [metadata[key] for key in REFERENCE_FREQUENCY_KEYS if key in metadata]
        if stated:
            try:
                quantity = units.Quantity(stated[0])
                if quantity.unit.is_equivalent(units.dimensionless_unscaled):
                    quantity = quantity * units.Hz
                frequency[:] = quantity.to_value(units.Hz)
            except (TypeError, ValueError) as error:
                raise InputError(
                    f"{columns.name}: its metadata give the reference frequency {stated[0]!r};"
                    " a number of Hz or a text such as '1.4 GHz' is needed"
                ) from error
    lowest, highest = RADIO_FREQUENCIES
    good = (frequency >= lowest) & (frequency <= highest)
    if not good.all():
        raise InputError(
            f"{columns.name}: the reference frequency is {frequency[~good][0]:g} Hz;"
            f" a frequency from {lowest:g} to {highest:g} Hz is needed"
        )
    return frequency
