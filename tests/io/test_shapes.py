import json
from pathlib import Path

import numpy as np
import pytest
import treecorr
from astropy.table import Table

from uvshear.constants import ARCSEC
from uvshear.errors import InputError
from uvshear.geometry.directions import PhaseCentre, equatorial
from uvshear.io.provenance import Provenance
from uvshear.io.shapes import (
    COLUMNS,
    averages_cells,
    extraction_record,
    inside,
    metadata,
    phase_centre_of,
    read_shapes,
    shapes_table,
    write_shapes,
)
from uvshear.typing import Array

CONTRACT = [
    "id",
    "ra",
    "dec",
    "l",
    "m",
    "flux",
    "e1",
    "e2",
    "e1_err",
    "e2_err",
    "e12_cov",
    "e_sigma",
    "weight",
    "snr",
    "scale_length",
    "scale_length_err",
    "flux_fit",
    "flux_fit_err",
    "dl",
    "dm",
    "flag",
]
CENTRE = PhaseCentre(1.0, np.radians(80.0))


QUALITY = ["detection", "resolved", "neighbour_distance", "error_widening", "remaining_change"]


def _values(n: int = 4) -> dict[str, Array]:
    rng = np.random.default_rng(3)
    values: dict[str, Array] = {
        name: rng.uniform(0.01, 0.02, n)
        for name in CONTRACT + QUALITY
        if name not in {"id", "ra", "dec", "flag"}
    }
    values |= {name: rng.uniform(1, 2, n) * ARCSEC for name in ("scale_length", "dl", "dm")}
    values["id"] = np.array([f"J{i}" for i in range(n)])
    values["flag"] = np.array(["ok"] * (n - 1) + ["no_peak"])
    for name in ("e1", "e2", "e1_err", "dl"):
        values[name][-1] = np.nan
    values["weight"][-1] = 0
    return values


def _table() -> Table:
    provenance = Provenance("uvshear measure α.ms", ("α.ms", "cat.fits"), {"uv_min": 1000.0})
    record = {"method": "a way of its own, " * 9, "sweeps": 3, "change": 1e-3, "done": True}
    return shapes_table(_values(), CENTRE, provenance, record=record)


def test_the_columns_are_those_of_the_contract_in_its_order() -> None:
    names = _table().colnames
    assert names[: len(CONTRACT)] == CONTRACT
    assert names[len(CONTRACT) :] == ["g1", "g2", "position_angle", *QUALITY]


@pytest.mark.parametrize("suffix", [".ecsv", ".fits"])
def test_units_descriptions_and_provenance_survive_a_file(tmp_path: Path, suffix: str) -> None:
    path = tmp_path / f"shapes{suffix}"
    table = _table()
    write_shapes(path, table)
    back = read_shapes(path)
    assert back.colnames == list(COLUMNS)
    for name, column in COLUMNS.items():
        assert back[name].description == column.description
        assert back[name].unit == table[name].unit
        if name in {"id", "flag"}:
            assert list(back[name]) == list(table[name])
        else:
            np.testing.assert_array_equal(inside(back, name), inside(table, name))
    meta = {str(key).lower(): value for key, value in back.meta.items()}
    assert meta["version"].startswith("uvshear ")
    assert meta["command"] == r"uvshear measure \u03b1.ms"
    assert meta["inputs"] == r'["\u03b1.ms", "cat.fits"]'
    assert meta["options"] == '{"uv_min": 1000.0}'
    record = json.loads(meta["extract"])
    assert record.pop("method") == "a way of its own, " * 9  # longer than a card of FITS
    assert record == {"sweeps": 3, "change": 1e-3, "done": True}


def test_units_at_the_edge_are_degrees_arcseconds_and_microjansky() -> None:
    values = _values()
    table = shapes_table(values, CENTRE)
    np.testing.assert_allclose(table["scale_length"] * ARCSEC, values["scale_length"])
    np.testing.assert_allclose(table["flux"] * 1e-6, values["flux"])
    assert table["ra"].unit == "deg"
    assert abs(table["dec"][0] - 80) < 2
    np.testing.assert_allclose(inside(table, "dl"), values["dl"])


def test_the_sky_frame_is_rotated_and_flipped_as_treecorr_wants_it() -> None:
    # on the meridian there is no rotation: g1 = e1, g2 = -e2, and e1 > 0 is long East-West
    values = _values(2)
    values |= {"l": np.zeros(2), "m": np.array([0.0, 0.01])}
    values |= {"e1": np.array([0.2, 0.0]), "e2": np.array([0.0, 0.2])}
    table = shapes_table(values, CENTRE)
    np.testing.assert_allclose(table["g1"], [0.2, 0], atol=1e-12)
    np.testing.assert_allclose(table["g2"], [0, -0.2], atol=1e-12)
    np.testing.assert_allclose(table["position_angle"], [90, 45], atol=1e-9)


def test_treecorr_takes_the_file_as_it_is(tmp_path: Path) -> None:
    """A tangential shear around a lens far off the centre, where local North is 0.06 rad from m."""
    lens, gamma_t, number = 0.0105 + 0.002j, 0.05, 4000
    rng = np.random.default_rng(5)
    offset = rng.uniform(2e-4, 2e-3, number) * np.exp(2j * np.pi * rng.uniform(0, 1, number))
    e = -gamma_t * (offset / np.abs(offset)) ** 2  # long axis across the line to the lens
    values = _values(number)
    values |= {"l": (lens + offset).real, "m": (lens + offset).imag, "e1": e.real, "e2": e.imag}
    # What was not measured has no ellipticity, and no weight; what weighs nothing has no say.
    values["weight"] = rng.uniform(1, 10, number)
    values["weight"][:200] = 0
    values["e1"][:100] = np.nan
    values["e2"][100:200] = 7.0
    path = tmp_path / "shapes.fits"
    write_shapes(path, shapes_table(values, CENTRE))
    names = {name: f"{name}_col" for name in ("ra", "dec", "g1", "g2")}
    columns = {option: name for name, option in names.items()}
    units_of_angle = {"ra_units": "deg", "dec_units": "deg"}
    sources = treecorr.Catalog(str(path), **columns, w_col="weight", **units_of_angle)
    assert sources.sumw == pytest.approx(values["weight"].sum())
    ra, dec = equatorial(CENTRE, np.array([lens.real]), np.array([lens.imag]))
    lenses = treecorr.Catalog(ra=np.degrees(ra), dec=np.degrees(dec), **units_of_angle)
    found = treecorr.NGCorrelation(min_sep=1e-4, max_sep=3e-3, nbins=4, sep_units="rad", brute=True)
    found.process(lenses, sources, num_threads=1)
    filled = found.npairs > 0
    np.testing.assert_allclose(found.xi[filled], gamma_t, rtol=2e-4)
    np.testing.assert_allclose(found.xi_im[filled], 0, atol=2e-4 * gamma_t)


def test_a_missing_value_is_named() -> None:
    values = _values()
    del values["e12_cov"]
    with pytest.raises(InputError, match="lacks e12_cov"):
        shapes_table(values, CENTRE)


@pytest.mark.parametrize(
    ("column", "value", "message"),
    [
        ("weight", None, "has no column 'weight'"),
        ("weight", -1.0, "column 'weight', row 1: is -1; a number between 0"),
        ("weight", np.nan, "column 'weight', row 1: is nan; a number between 0"),
        ("snr", ["high"] * 4, "column 'snr': holds no numbers"),
    ],
)
def test_a_wrong_table_of_shapes_is_refused(
    tmp_path: Path, column: str, value: object, message: str
) -> None:
    table = _table()
    del table[column]
    if value is not None:
        table[column] = value
    path = tmp_path / "shapes.ecsv"
    write_shapes(path, table)
    with pytest.raises(InputError, match=message):
        read_shapes(path)


def test_an_extension_without_a_format_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"the format of the table: \.ecsv, \.fits"):
        write_shapes(tmp_path / "shapes.txt", _table())
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("suffix", [".ecsv", ".fits"])
def test_the_phase_centre_is_that_of_the_axes(tmp_path: Path, suffix: str) -> None:
    path = tmp_path / f"shapes{suffix}"
    write_shapes(path, _table())
    centre = phase_centre_of(read_shapes(path))
    assert centre.ra == pytest.approx(CENTRE.ra)
    assert centre.dec == pytest.approx(CENTRE.dec)
    assert metadata(read_shapes(path))["ra0_deg"] == pytest.approx(np.degrees(CENTRE.ra))


@pytest.mark.parametrize("broken", [None, "north"])
def test_a_table_without_its_phase_centre_is_refused(broken: str | None) -> None:
    table = _table()
    if broken is None:
        del table.meta["dec0_deg"]
    else:
        table.meta["dec0_deg"] = broken
    with pytest.raises(InputError, match="lacks its phase centre"):
        phase_centre_of(table)


def test_the_record_of_the_extraction_is_read() -> None:
    table = _table()
    assert extraction_record(table)["sweeps"] == 3
    assert not averages_cells(table)
    table.meta["extract"] = json.dumps({"averages_cells": True})
    assert averages_cells(table)
    for text in ("a way of its own", "[1, 2]"):
        table.meta["extract"] = text
        assert extraction_record(table) == {}
    del table.meta["extract"]
    assert extraction_record(table) == {}


def test_columns_in_other_units_are_converted(tmp_path: Path) -> None:
    table = _table()
    table["scale_length"] = table["scale_length"].quantity.to("mas")
    table["flux"] = table["flux"].quantity.to("Jy")
    path = tmp_path / "shapes.ecsv"
    write_shapes(path, table)
    back = read_shapes(path)
    np.testing.assert_allclose(inside(back, "flux"), inside(_table(), "flux"))
    np.testing.assert_allclose(inside(back, "scale_length"), inside(_table(), "scale_length"))
    table["flux"].unit = "m"
    write_shapes(path, table, overwrite=True)
    with pytest.raises(InputError, match="column 'flux' is in 'm', which cannot be converted to"):
        read_shapes(path)


def test_a_column_that_is_not_there_is_named() -> None:
    table = _table()
    del table["flux"]
    with pytest.raises(InputError, match="no column 'flux'"):
        inside(table, "flux")
