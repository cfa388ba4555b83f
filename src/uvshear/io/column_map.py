"""Names of a catalogue's columns that differ from those of this package: ``ra=RAJ2000,flux=S_1400``."""

from collections.abc import Mapping

from uvshear.errors import InputError

KNOWN = (
    "id",
    "ra",
    "dec",
    "l",
    "m",
    "flux",
    "flux_err",
    "ra_err",
    "dec_err",
    "spectral_index",
    "reference_frequency",
    "scale_length",
    "scale_length_err",
    "profile",
    "e1",
    "e2",
    "shear1",
    "shear2",
)
"""Every column that a catalogue may have."""


def column_map_of(text: str) -> dict[str, str]:
    """Return the pairs of a text ``OURS=THEIRS,OURS=THEIRS``; a name may have blanks, but no comma or equals sign."""
    pairs = {}
    for part in text.split(","):
        ours, equals, theirs = (piece.strip() for piece in part.partition("="))
        if not (equals and ours and theirs):
            raise InputError(
                f"--column-map {text}: '{part}' is not a pair such as ra=RAJ2000; pairs OURS=THEIRS, separated by"
                " commas, are needed"
            )
        if ours in pairs:
            raise InputError(f"--column-map {text}: names '{ours}' twice")
        pairs[ours] = theirs
    check_column_map(pairs)
    return pairs


def check_column_map(pairs: Mapping[str, str]) -> None:
    """Refuse names that no catalogue column has."""
    for ours in pairs:
        if ours not in KNOWN:
            raise InputError(
                f"--column-map (column_map=): '{ours}' is no column of a catalogue; those are {', '.join(KNOWN)}"
            )


def found_names(pairs: Mapping[str, str], names: tuple[str, ...], table: str) -> dict[str, str]:
    """Return the map with the names as a table spells them; upper and lower case are alike where there is no doubt."""
    found = {}
    for ours, theirs in pairs.items():
        alike = [name for name in names if name.lower() == theirs.lower()]
        if theirs in names:
            alike = [theirs]
        if len(alike) != 1:
            raise InputError(
                f"{table}: has no column '{theirs}', which --column-map (column_map=) names for '{ours}'"
                f" (it has {', '.join(names)})"
            )
        found[ours] = alike[0]
    return found
