"""Quantities of a catalogue from columns of every kind."""

import re

import numpy as np
import pytest
from astropy import units
from astropy.table import Column, MaskedColumn, Table

from uvshear.constants import ARCSEC
from uvshear.errors import InputError
from uvshear.io.catalogue import catalogue_from_table
from uvshear.io.catalogue_columns import columns_of, finder_of, has_positions_and_fluxes


def _table(**columns):
    table = Table(
        {
            "id": ["a", "b", "c"],
            "ra": [17.0, 17.1, 17.2] * units.deg,
            "dec": [-28.0, -28.1, -28.2] * units.deg,
            "flux": [10.0, 20.0, 30.0] * units.uJy,
        }
    )
    for name, values in columns.items():
        table[name] = values
    return table


def _objects(*values):
    cells = np.empty(len(values), object)
    cells[:] = values
    return cells


@pytest.mark.parametrize(
    ("columns", "message"),
    [
        (
            {"flux": Column(["1", "2", "x"], unit="Jy")},
            "'flux' holds text ('x' for id c); a number is needed",
        ),
        ({"flux": Column(["1", "nan", "2"], unit="Jy")}, "'flux' is nan for id b; a finite number"),
        (
            {"flux": MaskedColumn([1.0, 2, 3], mask=[0, 1, 0], unit="Jy")},
            "'flux' has no value for id b",
        ),
        ({"flux": Column(_objects(1.0, None, 2.0), unit="Jy")}, "'flux' has no value for id b"),
        ({"flux": Column(np.ones((3, 4)), unit="Jy")}, "'flux' holds arrays"),
        ({"flux": Column([1 + 1j] * 3, unit="Jy")}, "'flux' holds values of the type complex128"),
        ({"flux": Column([True] * 3, unit="Jy")}, "'flux' holds values of the type bool"),
        ({"flux": Column([1.0] * 3, unit="furlongs")}, "'flux' is in 'furlongs', which is no unit"),
        (
            {"flux": Column([1.0] * 3, unit="Jy/beam")},
            "'flux' is in 'Jy / beam', which cannot be converted",
        ),
        (
            {"flux": Column([1.0] * 3, unit="mag(Jy)")},
            "'flux' is in 'mag(Jy)', which is no unit that is known",
        ),
        (
            {"ra": ["17:00:00", "17:61:00", "17:01:00"]},
            "'ra' holds text ('17:61:00' for id b); an angle",
        ),
        ({"ra": [17.0, 400.0, 17.0] * units.deg}, "'ra' is 400 for id b; -360 to 360 degrees"),
        ({"ra": MaskedColumn([1.0, 2, 3], mask=[0, 0, 1])}, "'ra' has no value for id c"),
        ({"flux_err": np.ones((3, 2))}, "'flux_err' holds arrays"),
        ({"flux_err": ["1", "x", "1"]}, "'flux_err' holds text ('x' for id b)"),
        ({"ra_err": [1.0] * 3 * units.Jy, "dec_err": [1.0] * 3}, "'ra_err' is in 'Jy'"),
        ({"spectral_index": ["flat", "0", "0"]}, "'spectral_index' holds text ('flat' for id a)"),
        ({"profile": np.array([["point"] * 2] * 3)}, "'profile' holds arrays"),
        ({"profile": [1, 2, 3]}, "'profile' holds numbers; words are needed"),
        (
            {"scale_length_err": ["?"] * 3, "scale_length": [1.0] * 3},
            "'scale_length_err' holds text",
        ),
        ({"id": np.ones((3, 2), int)}, "'id' holds arrays"),
        ({"id": [1.0, np.nan, 2.0]}, "'id', row 2: is empty"),
        ({"id": ["a", " ", "b"]}, "'id', row 2: is empty"),
        ({"id": ["a", "a ", "b"]}, "'id': a occurs 2 times"),
        ({"id": _objects("a", b"a", "b")}, "'id': a occurs 2 times"),
        ({"id": _objects(b"a", b"J\xe9", b"b")}, "'id' has the byte 0xe9 in row 2"),
    ],
)
def test_a_wrong_cell_is_named_in_a_line(columns, message):
    with pytest.raises(InputError, match=re.escape(message)) as caught:
        catalogue_from_table(_table(**columns), "cat.vot")
    assert str(caught.value).startswith("cat.vot: column ")
    assert "\n" not in str(caught.value)


def test_a_table_without_identifiers_names_the_row():
    table = _table(flux=[1.0, -2.0, 3.0] * units.Jy)
    table.remove_column("id")
    with pytest.raises(InputError, match="'flux' is -2 for row 2"):
        catalogue_from_table(table)


@pytest.mark.parametrize(
    ("identifier", "expected"),
    [
        (np.array([1, 2, 3], np.int16), [1, 2, 3]),
        (np.array([1, 2, 3], np.uint64), [1, 2, 3]),
        (np.array([1, 2, 2**64 - 1], np.uint64), ["1", "2", "18446744073709551615"]),
        (np.array([1.0, 2.0, 3.0]), [1, 2, 3]),
        (np.array([1.5, 2.0, 3.0]), ["1.5", "2.0", "3.0"]),
        (_objects("a", "bcd", "e"), ["a", "bcd", "e"]),
        (np.array([b"a ", b"b", b"c"]), ["a", "b", "c"]),
    ],
)
def test_identifiers_are_whole_numbers_or_text(identifier, expected):
    catalogue = catalogue_from_table(_table(id=identifier))
    assert catalogue.identifier.tolist() == expected
    assert catalogue.identifier.dtype.kind in "iU"


@pytest.mark.parametrize(
    ("unit", "jansky"),
    [("JY", 1.0), ("Jansky", 1.0), ("mJy", 1e-3), ("MJy", 1e6), ("W/(m2 Hz)", 1e26)],
)
def test_units_are_read_as_files_spell_them(unit, jansky):
    table = _table(flux=Column([1e-6] * 3, unit=unit))
    if jansky > 1e10:
        table["flux"] = Column([1e-32] * 3, unit=unit)
        jansky = 1.0
    assert catalogue_from_table(table).flux[0] == pytest.approx(1e-6 * jansky)


@pytest.mark.parametrize("kind", ["U", "O"])
def test_sexagesimal_text_of_any_type_is_read(kind):
    ra = np.array(["01:08:00", "01:08:24", "01:08:48.0"], kind)
    dec = np.array(["-28:00:00", "\u221228:06:00", "-28:12:00"], kind)
    catalogue = catalogue_from_table(_table(ra=Column(ra), dec=Column(dec)))
    np.testing.assert_allclose(np.degrees(catalogue.ra), [17.0, 17.1, 17.2])
    np.testing.assert_allclose(np.degrees(catalogue.dec), [-28.0, -28.1, -28.2])


def test_numbers_that_are_written_as_text_are_read():
    catalogue = catalogue_from_table(_table(ra=_objects("17.0", "1.71e1", "17.2")))
    np.testing.assert_allclose(np.degrees(catalogue.ra), [17.0, 17.1, 17.2])


def test_sizes_that_are_missing_are_not_known():
    table = _table(
        scale_length=MaskedColumn([1.0, 2.0, np.nan], mask=[False, True, False], unit="arcsec"),
        scale_length_err=[0.1, 0.2, np.nan] * units.arcsec,
    )
    catalogue = catalogue_from_table(table)
    np.testing.assert_allclose(catalogue.scale_length, np.array([1.0, np.nan, np.nan]) * ARCSEC)
    np.testing.assert_allclose(catalogue.scale_length_err, np.array([0.1, 0.2, 0.0]) * ARCSEC)


@pytest.mark.parametrize(
    ("metadata", "shift"),
    [({}, 0.0), ({"EQUINOX": 2000.0}, 0.0), ({"EQUINOX": 1950.0}, 0.6), ({"RADECSYS": "FK4"}, 0.6)],
)
def test_positions_are_precessed_to_icrs(metadata, shift):
    table = _table()
    table.meta.update(metadata)
    moved = np.degrees(catalogue_from_table(table).ra) - np.array([17.0, 17.1, 17.2])
    np.testing.assert_allclose(moved, shift, atol=0.03)


def test_a_column_of_b1950_is_precessed():
    table = _table()
    table.rename_columns(["ra", "dec"], ["RAB1950", "DEB1950"])
    catalogue = catalogue_from_table(table, column_map={"ra": "RAB1950", "dec": "DEB1950"})
    np.testing.assert_allclose(np.degrees(catalogue.ra) - [17.0, 17.1, 17.2], 0.6, atol=0.03)


def test_shears_in_another_frame_are_refused():
    table = _table(shear1=[0.1] * 3, shear2=[0.1] * 3)
    table.meta["EQUINOX"] = "B1950"
    with pytest.raises(InputError, match=re.escape("its positions are FK4 B1950, and its shears")):
        catalogue_from_table(table)


def test_galactic_coordinates_beside_equatorial_ones_are_no_direction_cosines():
    assert catalogue_from_table(_table(l=[300.0] * 3, b=[-85.0] * 3)).l is None


@pytest.mark.parametrize(
    ("names", "pairs", "expected"),
    [
        (["RA", "Dec", "Flux"], {}, True),
        (["l", "m", "flux"], {}, True),
        (["ra", "dec"], {}, False),
        (["ra", "flux"], {}, False),
        (["RAJ2000", "DEJ2000", "S"], {"ra": "RAJ2000", "dec": "DEJ2000", "flux": "S"}, True),
        (["RA", "DEC", "Total_flux"], {}, True),
    ],
)
def test_a_catalogue_is_told_by_its_columns(names, pairs, expected):
    assert has_positions_and_fluxes(names, pairs) is expected


def test_columns_of_a_finder_have_our_names():
    columns = columns_of(Table({"RA": [1.0], "DEC": [2.0], "Total_flux": [3.0]}), "list", {})
    assert columns.source("flux") == "Total_flux"
    assert finder_of(["x"]) is None
