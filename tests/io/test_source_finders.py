"""Catalogues of source finders."""

import numpy as np
import pytest
from astropy import units
from astropy.table import Table

from uvshear.constants import ARCSEC
from uvshear.io.catalogue import catalogue_from_table

DISC_OF_ONE = 2 * 1.67834699
"""FWHM of a Gaussian with the half-light radius of an exponential disc of scale length 1."""


def test_sizes_of_pybdsf_are_scale_lengths_and_what_it_does_not_resolve_are_points() -> None:
    table = Table(
        {
            "Source_id": [0, 1, 2],
            "Isl_id": [0, 1, 2],
            "RA": [10.0, 11.0, 12.0] * units.deg,
            "E_RA": [1e-5, 1e-5, 1e-5] * units.deg,
            "DEC": [-30.0, -31.0, -32.0] * units.deg,
            "E_DEC": [1e-5, 1e-5, 1e-5] * units.deg,
            "Total_flux": [1e-3, 2e-3, 3e-3] * units.Jy,
            "E_Total_flux": [1e-4, 2e-4, 3e-4] * units.Jy,
            "DC_Maj": np.array([2.0, 0.0, 4.0]) / 3600 * units.deg,
            "DC_Min": np.array([0.5, 0.0, 0.0]) / 3600 * units.deg,
            "S_Code": ["S", "S", "M"],
        }
    )
    catalogue = catalogue_from_table(table)
    assert catalogue.scale_length is not None
    np.testing.assert_allclose(
        catalogue.scale_length,
        np.array([np.sqrt(2.0), 0.0, np.sqrt(8.0)]) / DISC_OF_ONE * ARCSEC,
        rtol=1e-7,
    )
    assert catalogue.is_point is not None
    # one axis that is resolved is enough
    assert catalogue.is_point.tolist() == [False, True, False]
    np.testing.assert_allclose(catalogue.flux_err, [1e-4, 2e-4, 3e-4])
    np.testing.assert_allclose(catalogue.position_err, np.radians(1e-5))


def test_aegean_lists_are_recognised_and_deconvolved() -> None:
    """A round beam of 3 arcsec; a galaxy of 4 x 2 arcsec without it, and one that the beam hides."""
    galaxy = np.hypot([4.0, 2.0], 3.0)
    table = Table(
        {
            "island": [0, 1],
            "source": [0, 0],
            "ra": [52.0, 52.1],
            "dec": [-27.0, -27.1],
            "err_ra": [1e-5, -1.0],
            "err_dec": [1e-5, -1.0],
            "int_flux": [1e-3, 2e-3],
            "err_int_flux": [1e-5, -1.0],
            "a": [galaxy[0], 3.0],
            "b": [galaxy[1], 2.9],
            "pa": [30.0, 0.0],
            "psf_a": [3.0, 3.0],
            "psf_b": [3.0, 3.0],
            "psf_pa": [0.0, 0.0],
            "uuid": ["one", "two"],
        }
    )
    catalogue = catalogue_from_table(table)
    assert catalogue.identifier.tolist() == ["one", "two"]
    np.testing.assert_allclose(catalogue.flux, [1e-3, 2e-3])
    assert catalogue.scale_length is not None
    expected = np.array([np.sqrt(8.0), 0.0]) / DISC_OF_ONE * ARCSEC
    np.testing.assert_allclose(catalogue.scale_length, expected, rtol=1e-7, atol=1e-20)
    assert catalogue.is_point is not None
    assert catalogue.is_point.tolist() == [False, True]
    np.testing.assert_allclose(catalogue.flux_err, [1e-5, 0.0])


def test_the_half_light_radius_of_a_disc_is_galsims() -> None:
    galsim = pytest.importorskip("galsim")
    disc = galsim.Exponential(scale_radius=1.0)
    gaussian = galsim.Gaussian(half_light_radius=disc.half_light_radius)
    assert gaussian.fwhm == pytest.approx(DISC_OF_ONE, rel=1e-5)


def test_what_a_user_adds_to_a_finders_table_counts() -> None:
    table = Table(
        {
            "RA": [10.0, 11.0] * units.deg,
            "DEC": [-30.0, -31.0] * units.deg,
            "Total_flux": [1e-3, 2e-3] * units.Jy,
            "DC_Maj": [0.0, 1e-3] * units.deg,
            "DC_Min": [0.0, 1e-3] * units.deg,
            "spectral_index": [-0.1, 0.3],
            "Profile": ["galaxy", "point"],
        }
    )
    catalogue = catalogue_from_table(table)
    assert catalogue.spectral_index.tolist() == [-0.1, 0.3]
    assert catalogue.is_point is not None
    assert catalogue.is_point.tolist() == [False, True]
