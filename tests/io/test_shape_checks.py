"""Tables of shapes whose cells are not those of a table of shapes."""

from collections.abc import Callable

import numpy as np
import pytest
from astropy.table import Column, MaskedColumn, Table

from uvshear.errors import InputError
from uvshear.io.shape_checks import as_words, check_shapes

ROWS = 4


def _table() -> Table:
    table = Table({name: np.full(ROWS, 0.1) for name in ("l", "m", "e1", "e2", "e_sigma")})
    for name in ("weight", "flux", "snr", "detection"):
        table[name] = np.full(ROWS, 20.0)
    table["flag"] = ["ok", "ok", "no_peak", "ok"]
    for name in ("e1", "e2", "e_sigma", "snr", "detection"):
        table[name][2] = np.nan
    table["weight"][2] = 0.0
    return table


def _cell(name: str, value: object, row: int = 1) -> Callable[[Table], None]:
    def change(table: Table) -> None:
        table[name][row] = value

    return change


def _column(name: str, values: object) -> Callable[[Table], None]:
    def change(table: Table) -> None:
        table[name] = values

    return change


def test_a_table_of_shapes_is_accepted() -> None:
    check_shapes(_table(), "s.fits")


def test_a_row_that_was_not_measured_may_be_empty() -> None:
    table = _table()
    table["flag"] = MaskedColumn([b"ok", b"ok", b"no_peak ", b"unresolved"])
    table["e1"][3] = np.nan
    check_shapes(table, "s.fits")


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (_cell("e1", np.nan), "column 'e1', row 2: is nan; a number between -1 and 1 is needed"),
        (_cell("e2", 7.0, 2), "column 'e2', row 3: is 7; a number between -1 and 1 is needed"),
        (_cell("e_sigma", -0.1), "column 'e_sigma', row 2: is -0.1"),
        (_cell("weight", np.inf), "column 'weight', row 2: is inf"),
        (_cell("weight", 1e300), r"column 'weight', row 2: is 1e\+300"),
        (_cell("weight", np.nan, 2), "column 'weight', row 3: is nan"),
        (_cell("snr", 1e300), r"column 'snr', row 2: is 1e\+300"),
        (_cell("flux", -np.inf), "column 'flux', row 2: is -inf"),
        (_cell("m", 0.999), r"column 'l', row 2: is 0\.1; l\^2 \+ m\^2 must be 1 or less"),
        (_cell("l", np.nan), "column 'l', row 2: is nan"),
        (_cell("flag", "oj"), "column 'flag', row 2: is 'oj'; the word of a flag is needed"),
        (_column("flag", np.ones(ROWS)), "column 'flag': holds no words"),
        (_column("flag", [b"\xff\xfe"] * ROWS), "column 'flag': has letters beyond ASCII"),
        (_column("flag", [["ok", "ok"]] * ROWS), "column 'flag': holds no words"),
        (_column("e1", np.full((ROWS, 2), 0.1)), "column 'e1': holds arrays; one number"),
        (_column("e1", ["0.1"] * ROWS), "column 'e1': holds no numbers"),
        (_column("e1", np.full(ROWS, 0.1 + 0j)), "column 'e1': holds no numbers"),
        (_column("weight", np.ones(ROWS, bool)), "column 'weight': holds no numbers"),
        (
            _column("snr", MaskedColumn(np.ones(ROWS), mask=np.arange(ROWS) == 1)),
            "column 'snr', row 2: is nan",
        ),
        (lambda table: table.remove_column("weight"), "has no column 'weight'"),
    ],
)
def test_anything_else_is_one_line(change: Callable[[Table], None], message: str) -> None:
    table = _table()
    table["flag"] = Column(table["flag"], dtype="U16")
    change(table)
    with pytest.raises(InputError, match=rf"^s\.fits: {message}") as error:
        check_shapes(table, "s.fits")
    assert "\n" not in str(error.value)


def test_words_are_text_or_bytes_with_or_without_blanks() -> None:
    assert as_words(Column([b"ok ", b"no_peak"])).tolist() == ["ok", "no_peak"]
    assert as_words(MaskedColumn(["ok", "x"], mask=[False, True])).tolist() == ["ok", ""]
