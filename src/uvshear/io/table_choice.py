"""The table of a file that has several: FITS extensions, tables of a VOTable."""

import re
import warnings
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from uvshear.errors import DataWarning, InputError

_CHOICE = re.compile(r"(?P<file>.+)\[(?P<choice>[^\[\]]+)\]", re.DOTALL)


@dataclass(frozen=True)
class TableEntry:
    """A table in a file.

    Parameters
    ----------
    number
        Number by which it can be chosen; that of the extension in a FITS file.
    name
        Name by which it can be chosen; empty where it has none.
    rows
        Number of rows.
    columns
        Names of its columns.
    """

    number: int
    name: str
    rows: int
    columns: tuple[str, ...]

    @property
    def key(self) -> str:
        """The number, and the name if there is one."""
        return f"{self.number} ({self.name})" if self.name else f"{self.number}"


def file_and_choice(path: Path) -> tuple[Path, str | None]:
    """Split ``FILE[2]`` or ``FILE[NAME]`` into the file and the choice of a table in it."""
    if (match := _CHOICE.fullmatch(str(path))) is None or path.exists():
        return path, None
    return Path(match["file"]), match["choice"].strip()


def chosen_table(
    path: Path,
    tables: Sequence[TableEntry],
    choice: str | None,
    suits: Callable[[Sequence[str]], bool] | None,
) -> TableEntry:
    """Return the table that is asked for, or the only one that suits.

    Parameters
    ----------
    path
        The file, for messages.
    tables
        All of its tables.
    choice
        Number or name of the table that is asked for.
    suits
        Whether a table with these columns is what is needed; without it, the first table is taken.

    Warns
    -----
    DataWarning
        One of several tables was taken because it is the only one that suits.
    """
    if not tables:
        raise InputError(f"{path}: has no table")
    among = ", ".join(table.key for table in tables)
    if choice is not None:
        for table in tables:
            if choice == str(table.number) or choice.lower() == table.name.lower():
                return table
        raise InputError(f"{path}[{choice}]: has no such table; its tables are {among}")
    if suits is None or len(tables) == 1:
        return tables[0]
    fitting = [table for table in tables if suits(table.columns)]
    if len(fitting) == 1:
        others = len(tables) - 1
        warnings.warn(
            f"{path}: table {fitting[0].key} is read, because the other {others} of its tables"
            f" {'has' if others == 1 else 'have'} no positions and fluxes",
            DataWarning,
            stacklevel=2,
        )
        return fitting[0]
    if fitting:
        listed = ", ".join(f"{table.key} of {table.rows} rows" for table in fitting)
        raise InputError(
            f"{path}: has several tables with positions and fluxes ({listed});"
            f" choose one, as in {path.name}[{fitting[-1].number}]"
        )
    listed = "; ".join(f"{table.key} has {', '.join(table.columns[:8])}" for table in tables[:4])
    raise InputError(
        f"{path}: none of its {len(tables)} tables has positions and fluxes ({listed})"
    )
