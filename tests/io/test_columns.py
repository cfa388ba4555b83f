"""Columns of a user's table."""

import numpy as np
import pytest
from astropy import units
from astropy.table import MaskedColumn, QTable, Table

from uvshear.constants import ARCSEC
from uvshear.errors import InputError
from uvshear.io.columns import Columns


def _columns(**values: object) -> Columns:
    return Columns(Table(values), "mine.csv")


def test_columns_are_found_whatever_the_case() -> None:
    columns = _columns(Flux=[1.0, 2.0])
    assert columns.has("flux")
    assert columns.has("Flux")
    assert not columns.has("e1")
    np.testing.assert_array_equal(columns.number("flux", units.Jy, assumed=units.Jy), [1.0, 2.0])


def test_the_exact_spelling_comes_first() -> None:
    columns = _columns(FLUX=[1.0], flux=[2.0])
    assert columns.number("flux", units.Jy, assumed=units.Jy)[0] == 2.0


def test_numbers_are_in_the_unit_that_is_asked_for() -> None:
    columns = Columns(QTable({"size": [1.0, 2.0] * units.arcsec}), "mine.ecsv")
    np.testing.assert_allclose(columns.number("size", units.rad), np.array([1.0, 2.0]) * ARCSEC)


def test_a_column_without_unit_takes_the_given_one_then_the_assumed_one() -> None:
    columns = _columns(flux=[1.0])
    assert columns.number("flux", units.Jy, given="mJy", assumed=units.uJy)[0] == 1e-3
    assert columns.number("flux", units.Jy, assumed=units.uJy)[0] == pytest.approx(1e-6)
    assert columns.unit_of("flux", "mJy") == units.mJy


def test_rows_are_numbered_where_the_table_has_no_identifiers() -> None:
    assert _columns(flux=[1.0, 2.0]).identifier.tolist() == [1, 2]
    assert _columns(id=["b", "a"]).identifier.tolist() == ["b", "a"]


def test_words_are_in_lower_case_and_empty_where_there_is_none() -> None:
    words = MaskedColumn([" Point", "GALAXY", "point"], mask=[False, False, True])
    assert _columns(profile=words).words("profile").tolist() == ["point", "galaxy", ""]


def test_errors_that_are_not_known_are_zero() -> None:
    columns = _columns(flux_err=[1.0, -1.0, np.nan, np.inf])
    np.testing.assert_array_equal(
        columns.error("flux_err", units.Jy, assumed=units.Jy), [1.0, 0.0, 0.0, 0.0]
    )


def test_the_first_row_that_is_wrong_is_named() -> None:
    columns = _columns(id=[7, 8, 9], flux=[1.0, -2.0, -3.0])
    flux = columns.number("flux", units.Jy, assumed=units.Jy)
    with pytest.raises(
        InputError, match=r"mine\.csv: column 'flux' is -2 for id 8; more is needed"
    ):
        columns.require("flux", flux > 0, "more is needed", flux)


def test_keys_of_metadata_are_in_lower_case() -> None:
    table = Table({"flux": [1.0]}, meta={"REFFREQ": 1.1e9})
    assert Columns(table, "mine.fits").metadata == {"reffreq": 1.1e9}
