import math
from pathlib import Path

import numpy as np
import pytest
from astropy import units
from astropy.table import MaskedColumn, QTable, Table

from uvshear.constants import ARCSEC
from uvshear.errors import DataWarning, InputError
from uvshear.galaxy import PROFILES
from uvshear.galaxy.galaxies import Galaxies
from uvshear.geometry.directions import PhaseCentre
from uvshear.io.catalogue import (
    Catalogue,
    catalogue_from_galaxies,
    catalogue_from_table,
    catalogue_table,
    read_catalogue,
    write_catalogue,
)
from uvshear.io.provenance import Provenance

CENTRE = PhaseCentre(0.3, -0.5)


def _table(**columns: object) -> Table:
    table = Table(
        {
            "id": [7, 8, 9],
            "ra": [17.0, 17.1, 17.2] * units.deg,
            "dec": [-28.0, -28.1, -28.2] * units.deg,
            "flux": [10.0, 20.0, 30.0] * units.uJy,
        }
    )
    for name, values in columns.items():
        table[name] = values
    return Table(table)


@pytest.mark.parametrize("suffix", [".ecsv", ".fits", ".vot"])
def test_every_format_with_units_gives_the_same_catalogue(tmp_path: Path, suffix: str) -> None:
    path = tmp_path / f"cat{suffix}"
    table = _table(scale_length=[0.5, 1.0, 2.0] * units.arcsec, e1=[0.1, 0, -0.2], e2=[0.0, 0, 0.3])
    table.write(path, format={".ecsv": "ascii.ecsv", ".fits": "fits", ".vot": "votable"}[suffix])
    catalogue = read_catalogue(path)
    assert catalogue.identifier.tolist() == [7, 8, 9]
    assert catalogue.ra is not None
    assert catalogue.scale_length is not None
    assert catalogue.ellipticity is not None
    np.testing.assert_allclose(catalogue.ra, np.radians([17.0, 17.1, 17.2]), rtol=1e-15)
    np.testing.assert_allclose(catalogue.flux, [1e-5, 2e-5, 3e-5], rtol=1e-15)
    np.testing.assert_allclose(catalogue.scale_length, np.array([0.5, 1, 2]) * ARCSEC, rtol=1e-12)
    assert catalogue.ellipticity[2] == -0.2 + 0.3j
    assert catalogue.reference_frequency == 1.4e9
    assert np.all(catalogue.spectral_index == -0.7)


def test_csv_takes_its_flux_unit_from_the_option(tmp_path: Path) -> None:
    path = tmp_path / "cat.csv"
    path.write_text("l,m,flux\n0.001,0.002,50\n-0.001,0,70\n")
    with pytest.warns(DataWarning, match="has no column of identifiers; its sources are numbered"):
        catalogue = read_catalogue(path, flux_unit="uJy")
    np.testing.assert_allclose(catalogue.flux, [5e-5, 7e-5])
    assert catalogue.identifier.tolist() == [1, 2]
    assert catalogue.l is not None
    assert catalogue.l.tolist() == [0.001, -0.001]


def test_the_unit_of_the_column_wins_over_the_default() -> None:
    table = _table(scale_length=[1e-6, 2e-6, 3e-6] * units.rad)
    table["ra"] = [0.1, 0.2, 0.3] * units.hourangle
    catalogue = catalogue_from_table(table)
    assert catalogue.ra is not None
    assert catalogue.scale_length is not None
    np.testing.assert_allclose(catalogue.ra, np.array([0.1, 0.2, 0.3]) * math.pi / 12)
    np.testing.assert_allclose(catalogue.scale_length, [1e-6, 2e-6, 3e-6])


def test_quantity_tables_are_taken() -> None:
    assert len(catalogue_from_table(QTable(_table()))) == 3


def test_pybdsf_lists_are_recognised() -> None:
    table = Table(
        {
            "Source_id": [0, 1],
            "RA": [10.0, 11.0] * units.deg,
            "E_RA": [0.1, 0.1] * units.deg,
            "DEC": [-30.0, -31.0] * units.deg,
            "Total_flux": [1e-3, 2e-3] * units.Jy,
        },
        meta={"FREQ0": 9.5e8},
    )
    with pytest.warns(DataWarning, match="no sizes with units are in it"):
        catalogue = catalogue_from_table(table)
    assert catalogue.identifier.tolist() == [0, 1]
    assert catalogue.flux.tolist() == [1e-3, 2e-3]
    assert catalogue.reference_frequency == 9.5e8


@pytest.mark.parametrize("stated", [1.1e9, "1.1 GHz", 1100 * units.MHz])
def test_the_reference_frequency_comes_from_the_metadata(stated: object) -> None:
    table = _table()
    table.meta["reference_frequency"] = stated
    assert catalogue_from_table(table).reference_frequency == pytest.approx(1.1e9)


def test_an_option_wins_over_the_metadata() -> None:
    table = _table()
    table.meta["reference_frequency"] = 1.1e9
    assert catalogue_from_table(table, reference_frequency=3e9).reference_frequency == 3e9


def test_fluxes_at_different_frequencies_are_brought_to_one() -> None:
    table = _table(
        reference_frequency=[1.0, 1.4, 2.0] * units.GHz, spectral_index=[-0.7, -0.7, 1.0]
    )
    catalogue = catalogue_from_table(table)
    assert catalogue.reference_frequency == 1e9
    # S(1 GHz) = S(nu) (1 GHz / nu)^beta
    expected = [10e-6, 20e-6 * 1.4**0.7, 30e-6 / 2]
    np.testing.assert_allclose(catalogue.flux, expected, rtol=1e-14)


def test_directions_agree_with_the_cosines_given() -> None:
    l, m = np.array([0.01, -0.02]), np.array([0.005, 0.0])
    galaxies = Galaxies(
        l=l,
        m=m,
        flux=np.full(2, 1e-5),
        scale_length=np.full(2, 1e-6),
        ellipticity=np.zeros(2, complex),
        spectral_index=np.full(2, -0.7),
    )
    by_cosines = catalogue_from_galaxies(galaxies).directions(CENTRE)
    by_equatorial = catalogue_from_galaxies(galaxies, CENTRE).directions(CENTRE)
    np.testing.assert_allclose(by_equatorial, by_cosines, atol=1e-15)
    np.testing.assert_allclose(np.sum(np.square(by_cosines), axis=0), 1, rtol=1e-15)


@pytest.mark.parametrize("suffix", [".ecsv", ".fits", ".vot"])
@pytest.mark.parametrize("centre", [None, CENTRE])
def test_a_written_catalogue_is_read_back(
    tmp_path: Path, suffix: str, centre: PhaseCentre | None
) -> None:
    rng = np.random.default_rng(1)
    galaxies = Galaxies(
        l=rng.normal(0, 1e-3, 5),
        m=rng.normal(0, 1e-3, 5),
        flux=rng.uniform(1e-5, 1e-4, 5),
        scale_length=rng.uniform(1e-6, 1e-5, 5),
        ellipticity=rng.normal(0, 0.1, 5) + 1j * rng.normal(0, 0.1, 5),
        spectral_index=np.full(5, -0.8),
        reference_frequency=1.1e9,
    )
    path = tmp_path / f"cat{suffix}"
    provenance = Provenance("uvshear catalogue", options={"seed": 1})
    write_catalogue(path, catalogue_from_galaxies(galaxies, centre), provenance.metadata())
    back = read_catalogue(path).galaxies(CENTRE)
    for name in ("l", "m", "flux", "scale_length", "ellipticity", "spectral_index"):
        expected = getattr(galaxies, name)
        np.testing.assert_allclose(getattr(back, name), expected, rtol=1e-12, atol=1e-16)
    if suffix != ".vot":
        assert back.reference_frequency == 1.1e9
        meta = {k.lower(): v for k, v in Table.read(path).meta.items()}
        assert meta["command"] == "uvshear catalogue"


def test_a_source_behind_the_phase_centre_is_no_galaxy_to_simulate() -> None:
    with pytest.raises(InputError, match="id 9 is 90 degrees or more"):
        catalogue_from_table(_table()).galaxies(PhaseCentre(0.3 + math.pi, 0.5))


def _wrong(message: str, **columns: object) -> object:
    return pytest.param(_table(**columns), message, id=message)


@pytest.mark.parametrize(
    ("table", "message"),
    [
        _wrong(
            "column 'flux' is nan for id 8; a positive|finite", flux=[1, math.nan, 1] * units.Jy
        ),
        _wrong("column 'flux' is -3 for id 9; a positive", flux=[1, 1, -3] * units.Jy),
        _wrong("column 'flux' is 0 for id 7; a positive", flux=[0, 1, 1] * units.Jy),
        _wrong("column 'flux' has no unit", flux=[1.0, 1, 1]),
        _wrong(
            "column 'flux' is in 'm', which cannot be converted to Jy", flux=[1.0, 1, 1] * units.m
        ),
        _wrong("column 'flux' holds text", flux=["a", "b", "c"]),
        _wrong("column 'ra' is nan for id 7", ra=[math.nan, 1, 1] * units.deg),
        _wrong("column 'dec' is -91 for id 8", dec=[0, -91, 1] * units.deg),
        _wrong("column 'dec' is in 's'", dec=[0, -91, 1] * units.s),
        _wrong("column 'id': 7 occurs 2 times", id=[7, 7, 8]),
        _wrong("column 'id': b occurs 2 times", id=["b", "b", "c"]),
        _wrong("column 'id', row 2: is empty", id=MaskedColumn([1, 2, 3], mask=[0, 1, 0])),
        _wrong("column 'e1, e2' is .* for id 9", e1=[0, 0, 0.8], e2=[0, 0, 0.6]),
        _wrong("has no column 'e2'", e1=[0, 0, 0.8]),
        _wrong("column 'shear1, shear2' is .* for id 8", shear1=[0, 1.0, 0], shear2=[0, 0, 0]),
        _wrong("has no column 'shear1'; give both shear1 and shear2", shear2=[0, 0, 0.8]),
        _wrong("column 'profile' has 'square'", profile=["point", "square", ""]),
        _wrong("column 'scale_length' is -.* for id 8", scale_length=[1.0, -1, 1]),
        _wrong("column 'spectral_index' is nan for id 8", spectral_index=[1.0, math.nan, 1]),
        _wrong("column 'flux' is 1e.30 for id 8; less than", flux=[1.0, 1e30, 1] * units.Jy),
        _wrong("column 'scale_length' is .* for id 9; a size below", scale_length=[1.0, 1, 1e9]),
        _wrong(
            "column 'spectral_index' is 1e.05 for id 7; -100 to 100", spectral_index=[1e5, 0, 0]
        ),
        _wrong("column 'ra' holds text", ra=["here", "there", "near"]),
        _wrong("column 'ra' holds arrays", ra=np.zeros((3, 2))),
    ],
)
def test_a_wrong_column_is_named_with_its_row_and_what_is_needed(
    table: Table, message: str
) -> None:
    with pytest.raises(InputError, match=message) as caught:
        catalogue_from_table(table, "cat.fits")
    assert str(caught.value).startswith("cat.fits: ")
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("absent", "message"),
    [
        ("flux", "has no column 'flux' (it has id, ra, dec)"),
        ("ra", "has no column 'ra' to go with 'dec'"),
    ],
)
def test_a_missing_column_is_named(absent: str, message: str) -> None:
    table = _table()
    del table[absent]
    with pytest.raises(InputError) as caught:
        catalogue_from_table(table)
    assert message in str(caught.value)


def test_a_catalogue_without_positions_says_which_are_possible() -> None:
    table = _table()
    table.remove_columns(["ra", "dec"])
    with pytest.raises(InputError, match=r"'ra' and 'dec' \(deg\), or 'l' and 'm' \(rad\)"):
        catalogue_from_table(table)


def test_an_empty_catalogue_is_refused() -> None:
    with pytest.raises(InputError, match="has no rows"):
        catalogue_from_table(_table()[:0])


@pytest.mark.parametrize("stated", ["fast", -1.0, 0.0, 1.4, 1e30, math.nan])
def test_a_wrong_reference_frequency_is_refused(stated: object) -> None:
    table = _table()
    table.meta["reference_frequency"] = stated
    with pytest.raises(InputError, match="reference frequency"):
        catalogue_from_table(table)


def test_a_flux_unit_that_is_none_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "cat.csv"
    path.write_text("l,m,flux\n0.001,0.002,50\n")
    with pytest.raises(InputError, match=r"--flux-unit jansky2x .flux_unit=.: is not a unit"):
        read_catalogue(path, flux_unit="jansky2x")


@pytest.mark.parametrize(
    ("name", "content", "message"),
    [
        ("absent.fits", None, "no such file"),
        ("empty.fits", b"", "is empty"),
        ("noise.fits", b"\x00\x01\x02" * 99, "cannot be read as a table"),
        ("noise.ecsv", b"what is this\n", "cannot be read as a table"),
        ("noise.dat", b"\x80\x81\x00" * 50, "cannot be read as a table"),
        ("rows.csv", b"l,m,flux\n", "has no rows"),
    ],
)
def test_a_file_that_is_no_catalogue_is_named_in_one_line(
    tmp_path: Path, name: str, content: bytes | None, message: str
) -> None:
    path = tmp_path / name
    if content is not None:
        path.write_bytes(content)
    with pytest.raises(InputError, match=message) as caught:
        read_catalogue(path)
    assert str(caught.value).startswith(str(path))
    assert "\n" not in str(caught.value)


def test_a_directory_is_no_catalogue(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="is a directory"):
        read_catalogue(tmp_path)


def test_selecting_keeps_what_is_absent_absent() -> None:
    chosen = catalogue_from_table(_table()).select(np.array([2, 0]))
    assert isinstance(chosen, Catalogue)
    assert chosen.identifier.tolist() == [9, 7]
    assert chosen.scale_length is None
    assert chosen.l is None


@pytest.mark.parametrize("suffix", [".ecsv", ".fits"])
def test_the_centre_of_a_simulated_field_is_kept(tmp_path: Path, suffix: str) -> None:
    path = tmp_path / f"cat{suffix}"
    one = np.zeros(1)
    galaxies = Galaxies(one, one, one + 1e-5, one, one.astype(complex), one)
    write_catalogue(path, catalogue_from_galaxies(galaxies, CENTRE))
    centre = read_catalogue(path).field_centre
    assert centre is not None
    assert centre.ra == pytest.approx(CENTRE.ra, abs=1e-15)
    assert centre.dec == pytest.approx(CENTRE.dec, abs=1e-15)


@pytest.mark.parametrize(
    ("ra", "dec"),
    [
        (["03:28:12.63", "03:28:13", "03:28:14"], ["-27:35:15.0", "-27:35:16", "-27:35:17"]),
        (["3h28m12.63s", "3h28m13s", "3h28m14s"], ["-27d35m15s", "-27d35m16s", "-27d35m17s"]),
        (["3 28 12.63", "3 28 13", "3 28 14"], ["-27 35 15", "-27 35 16", "-27 35 17"]),
    ],
)
def test_angles_that_are_written_out_are_read(ra: list[str], dec: list[str]) -> None:
    catalogue = catalogue_from_table(_table(ra=ra, dec=dec))
    assert catalogue.ra is not None
    assert catalogue.dec is not None
    assert np.degrees(catalogue.ra[0]) == pytest.approx(15 * (3 + 28 / 60 + 12.63 / 3600))
    assert np.degrees(catalogue.dec[0]) == pytest.approx(-(27 + 35 / 60 + 15 / 3600))


def test_errors_of_flux_and_position_are_kept() -> None:
    catalogue = catalogue_from_table(
        _table(
            flux_err=[1.0, 2.0, np.nan],
            ra_err=[3e-5, 0.0, 3e-5] * units.deg,
            dec_err=[0.0, 0.0, 3e-5] * units.deg,
        )
    )
    np.testing.assert_allclose(catalogue.flux_err, [1e-6, 2e-6, 0.0])
    expected = np.radians(3e-5) * np.array([np.sqrt(0.5), 0.0, 1.0])
    np.testing.assert_allclose(catalogue.position_err, expected)
    assert catalogue_from_table(_table()).flux_err is None
    assert catalogue_from_table(_table()).position_err is None


def test_every_known_profile_stands_for_a_galaxy() -> None:
    names = [*PROFILES.names(), "galaxy", "", "Point"]
    rows = len(names)
    table = Table(
        {
            "l": np.linspace(0, 1e-3, rows),
            "m": np.zeros(rows),
            "flux": np.ones(rows) * units.uJy,
            "profile": names,
        }
    )
    catalogue = catalogue_from_table(table)
    assert catalogue.is_point is not None
    assert {"sersic-2", "disc-bulge"} < set(names)
    assert catalogue.is_point.tolist() == [False] * (rows - 1) + [True]


@pytest.mark.parametrize("suffix", [".ecsv", ".fits", ".vot"])
def test_shears_in_the_sky_frame_are_read_and_written(tmp_path: Path, suffix: str) -> None:
    shear = np.array([0.01 + 0.02j, -0.03j, 0])
    catalogue = catalogue_from_table(_table(shear1=shear.real, shear2=shear.imag))
    assert catalogue.shear is not None
    np.testing.assert_array_equal(catalogue.shear, shear)
    assert catalogue.ellipticity is None
    path = tmp_path / f"sheared{suffix}"
    write_catalogue(path, catalogue)
    back = read_catalogue(path)
    assert back.shear is not None
    np.testing.assert_array_equal(back.shear, shear)
    chosen = catalogue.select(np.array([1])).shear
    assert chosen is not None
    np.testing.assert_array_equal(chosen, shear[[1]])


def test_a_catalogue_without_shears_has_none() -> None:
    catalogue = catalogue_from_table(_table())
    assert catalogue.shear is None
    assert "shear1" not in catalogue_table(catalogue).colnames
