"""Lists of PyBDSF in its own formats.

``tests/io/pybdsf`` has the lists that PyBDSF 1.14.1 wrote of one image of nine sources, with a beam of 4 x 3 arcsec.
"""

import re
from pathlib import Path

import numpy as np
import pytest
from astropy import units
from astropy.table import Table

from uvshear.constants import ARCSEC
from uvshear.errors import DataWarning, InputError
from uvshear.io.catalogue import catalogue_from_table, read_catalogue
from uvshear.io.source_finders import FWHM_OF_SCALE_LENGTH

LISTS = Path(__file__).parent / "pybdsf"
FORMATS = ("image.srl", "image.srl.csv", "image.srl.fits")

WIDTHS = np.sqrt([4 * 2, 2 * 1, 0, 3 * 3, 6 * 4, 4 * 2, 6 * 4, 0, 2 * 1])
"""Geometric means of the axes that were put into the image [arcsec], in the order of the lists."""


def _copy(tmp_path, change):
    """Copy of the text list with its words changed."""
    path = tmp_path / "image.srl"
    path.write_text(change((LISTS / "image.srl").read_text()))
    return path


def test_the_fits_list_is_read_as_it_is():
    catalogue = read_catalogue(LISTS / "image.srl.fits")
    table = Table.read(LISTS / "image.srl.fits")
    assert catalogue.identifier.tolist() == list(range(9))
    np.testing.assert_allclose(catalogue.ra, np.radians(table["RA"]), rtol=1e-15)
    np.testing.assert_allclose(catalogue.dec, np.radians(table["DEC"]), rtol=1e-15)
    np.testing.assert_allclose(catalogue.flux, table["Total_flux"])
    np.testing.assert_allclose(catalogue.flux_err, table["E_Total_flux"])
    assert catalogue.reference_frequency == 1.3e9
    assert catalogue.is_point is None


@pytest.mark.parametrize("kind", ["srl", "gaul"])
@pytest.mark.parametrize("suffix", ["", ".csv"])
def test_text_and_csv_lists_are_the_fits_list(kind, suffix):
    from_fits = read_catalogue(LISTS / f"image.{kind}.fits")
    from_text = read_catalogue(LISTS / f"image.{kind}{suffix}")
    assert from_text.identifier.tolist() == from_fits.identifier.tolist()
    assert from_text.reference_frequency == from_fits.reference_frequency
    # Texts have 14 decimals.
    for name in (
        "ra",
        "dec",
        "flux",
        "flux_err",
        "position_err",
        "scale_length",
        "scale_length_err",
    ):
        np.testing.assert_allclose(
            getattr(from_text, name), getattr(from_fits, name), rtol=1e-7, err_msg=name
        )


@pytest.mark.parametrize("name", FORMATS)
def test_sizes_are_those_that_were_put_into_the_image(name):
    catalogue = read_catalogue(LISTS / name)
    width = catalogue.scale_length / ARCSEC * FWHM_OF_SCALE_LENGTH
    err = catalogue.scale_length_err / ARCSEC * FWHM_OF_SCALE_LENGTH
    is_limit = np.isclose(err / width, np.sqrt(np.e - 1))
    # Source 2 has no size, and neither has the faint source 7.
    assert is_limit.tolist() == [False] * 2 + [True] + [False] * 4 + [True, False]
    assert np.all(WIDTHS[is_limit] < 2 * width[is_limit])
    # PyBDSF's own errors, those of the fit, are half of these for the small source 1: it would be 3.5 of them off.
    pull = (width - WIDTHS)[~is_limit] / err[~is_limit]
    assert np.all(np.abs(pull) < 2)
    assert np.all(err[~is_limit] < 0.3 * width[~is_limit])


def test_sizes_without_a_source_that_tells_the_beam_come_from_the_beam_of_the_header():
    """The comments of a FITS list have the header of the image."""
    table = Table.read(LISTS / "image.srl.fits")
    known = catalogue_from_table(table).scale_length
    table.remove_columns(["DC_Maj", "DC_Min", "DC_PA"])
    np.testing.assert_allclose(catalogue_from_table(table).scale_length, known, rtol=1e-3)


def test_without_a_beam_sizes_are_pybdsf_s_own_and_that_is_said(tmp_path):
    # A list whose sources are all unresolved along one axis at least does not tell the beam.
    table = Table.read(LISTS / "image.srl.fits")
    table.meta = {}
    table["DC_Min"][:] = 0.0
    with pytest.warns(DataWarning, match="does not tell the beam: the sizes are PyBDSF's own"):
        catalogue = catalogue_from_table(table)
    own = np.sqrt(0.5) * np.asarray(table["DC_Maj"]) * 3600 * ARCSEC / FWHM_OF_SCALE_LENGTH
    fitted = np.sqrt(table["Maj"] * table["Min"]) * 3600 * ARCSEC / FWHM_OF_SCALE_LENGTH
    np.testing.assert_allclose(catalogue.scale_length, np.where(own > 0, own, fitted / 2))


def test_a_size_that_is_not_known_at_all_follows_from_the_flux():
    table = Table.read(LISTS / "image.srl.fits")[
        ["Source_id", "RA", "DEC", "Total_flux", "DC_Maj", "DC_Min"]
    ]
    with pytest.warns(DataWarning, match="no Maj, Min and PA: the sizes are PyBDSF's own"):
        catalogue = catalogue_from_table(table)
    assert np.isnan(catalogue.scale_length).tolist() == [False] * 2 + [True] + [False] * 6


@pytest.mark.parametrize("program", ["PyBDSF version 1.8.15", "PyBDSM version 1.13.0"])
def test_units_are_pybdsf_s_where_it_wrote_the_text(tmp_path, program):
    path = _copy(tmp_path, lambda text: re.sub(r"PyBDSF version [\d.]+", program, text))
    np.testing.assert_array_equal(
        read_catalogue(path).flux, read_catalogue(LISTS / "image.srl").flux
    )


def test_text_of_others_with_these_columns_needs_a_unit_of_flux(tmp_path):
    """LoTSS has PyBDSF's columns in mJy and arcsec."""
    path = _copy(tmp_path, lambda text: re.sub(r"(?m)^# (?!Source_id).*\n", "", text))
    with pytest.raises(InputError, match="'Total_flux' has no unit"):
        read_catalogue(path)
    with pytest.warns(DataWarning, match="no sizes with units"):
        catalogue = read_catalogue(path, flux_unit="mJy")
    np.testing.assert_allclose(catalogue.flux, read_catalogue(LISTS / "image.srl").flux / 1e3)
    assert catalogue.scale_length is None
    assert catalogue.position_err is None


def test_a_text_list_of_another_equinox_is_precessed(tmp_path):
    path = _copy(tmp_path, lambda text: text.replace("Equinox : 2000.0", "Equinox : 1950.0"))
    before, after = read_catalogue(LISTS / "image.srl"), read_catalogue(path)
    # 46.1 and 20.04 arcsec a year along the equator, and towards the equinox
    years, ra, dec = 50 / 3600, np.radians(60.0), np.radians(-30.0)
    along = years * (46.1 + 20.04 * np.sin(ra) * np.tan(dec))
    assert np.degrees(after.ra - before.ra).mean() == pytest.approx(along, abs=0.003)
    assert np.degrees(after.dec - before.dec).mean() == pytest.approx(
        years * 20.04 * np.cos(ra), abs=0.003
    )


@pytest.mark.parametrize("equinox", ["None", "2000.0", "J2000"])
def test_a_list_without_equinox_or_of_j2000_is_taken_as_it_is(tmp_path, equinox):
    path = _copy(tmp_path, lambda text: text.replace("Equinox : 2000.0", f"Equinox : {equinox}"))
    np.testing.assert_array_equal(read_catalogue(path).ra, read_catalogue(LISTS / "image.srl").ra)


def test_names_of_sources_are_identifiers():
    table = Table.read(LISTS / "image.srl.fits")
    table["Source_Name"] = [f"ILTJ{k:04d}" for k in range(9)]
    assert catalogue_from_table(table).identifier[2] == "ILTJ0002"


def test_a_list_without_sources_has_no_rows(tmp_path):
    path = _copy(tmp_path, lambda text: "".join(text.splitlines(keepends=True)[:6]))
    with pytest.raises(InputError, match="has no rows"):
        read_catalogue(path)


def _broken(message, **columns):
    return pytest.param(columns, message, id=message)


@pytest.mark.parametrize(
    ("columns", "message"),
    [
        _broken("'Maj' holds text ('wide' for id 0)", Maj=["wide"] * 9),
        _broken("'E_PA' holds text ('?' for id 0)", E_PA=["?"] * 9),
        _broken("'DC_Min' holds arrays", DC_Min=np.zeros((9, 2)) * units.deg),
        _broken(
            "'Total_flux' is in 'counts', which is no unit",
            Total_flux=Table.Column([1.0] * 9, unit="counts"),
        ),
        _broken("'E_RA' is in 'Jy', which cannot be converted to rad", E_RA=[1.0] * 9 * units.Jy),
        _broken("'Total_flux' is nan for id 0", Total_flux=[np.nan] * 9 * units.Jy),
    ],
)
def test_a_wrong_column_is_named_as_the_list_names_it(columns, message):
    table = Table.read(LISTS / "image.srl.fits")
    for name, values in columns.items():
        table[name] = values
    with pytest.raises(InputError, match=re.escape(message)) as caught:
        catalogue_from_table(table, "image.fits")
    assert str(caught.value).startswith("image.fits: column ")
    assert "\n" not in str(caught.value)


def test_missing_sizes_of_some_sources_follow_from_their_fluxes():
    table = Table.read(LISTS / "image.srl.fits", astropy_native=True)
    table = Table(table, masked=True)
    table["Maj"].mask[3] = True
    catalogue = catalogue_from_table(table)
    assert np.isnan(catalogue.scale_length).tolist() == [False] * 3 + [True] + [False] * 5
