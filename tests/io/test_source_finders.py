"""What source finders share."""

import numpy as np
import pytest
from astropy import units
from astropy.table import Table

from uvshear.errors import DataWarning
from uvshear.galaxy import CatalogueSize
from uvshear.geometry.deconvolution import Widths
from uvshear.io.catalogue import catalogue_from_table
from uvshear.io.source_finders import FWHM_OF_SCALE_LENGTH, Sizes


def test_the_half_light_radius_of_a_disc_is_galsims():
    galsim = pytest.importorskip("galsim")
    disc = galsim.Exponential(scale_radius=1.0)
    gaussian = galsim.Gaussian(half_light_radius=disc.half_light_radius)
    assert gaussian.fwhm == pytest.approx(FWHM_OF_SCALE_LENGTH, rel=1e-5)


def test_what_is_not_resolved_has_half_the_limit_and_a_wide_prior():
    widths = Widths(np.array([3.0, 2.0]), np.array([0.3, 0.0]), np.array([True, False]))
    sizes = Sizes.from_widths(widths)
    np.testing.assert_allclose(sizes.scale_length * FWHM_OF_SCALE_LENGTH, [3.0, 1.0])
    prior = CatalogueSize(sigma=0.3).prior(np.full(2, 1e-4), sizes.scale_length, sizes.err)
    np.testing.assert_allclose(np.exp(prior.log_median), sizes.scale_length)
    np.testing.assert_allclose(prior.sigma**2, [0.09 + np.log(1.01), 0.09 + 1.0])


def test_what_a_user_adds_to_a_finders_table_counts():
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
    with pytest.warns(DataWarning, match="no Maj, Min and PA"):
        catalogue = catalogue_from_table(table)
    assert catalogue.spectral_index.tolist() == [-0.1, 0.3]
    assert catalogue.is_point is not None
    assert catalogue.is_point.tolist() == [False, True]
