"""Options for reading visibilities."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Reading:
    """Options that say which visibilities of a file are read, and how.

    A reader raises an error for an option that its format does not support.

    Parameters
    ----------
    column
        Column of visibilities.
    field
        Number or name of the field; needed only where there are several.
    scans
        Numbers of the scans to read; all unless given.
    heeds_flags
        Whether flagged visibilities are left out.
    conjugates
        Whether UVW is taken with the opposite sign.
    subtracted
        Column of a model that is subtracted from the visibilities.
    reader
        Reader of the format, or its registered name, or ``MODULE:NAME``; by default the first reader that recognises
        the file.
    """

    column: str = "DATA"
    field: int | str | None = None
    scans: tuple[int, ...] | None = None
    heeds_flags: bool = True
    conjugates: bool = False
    subtracted: str | None = None
    reader: object = None
