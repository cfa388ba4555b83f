"""Priors of the modelled sources, and the unit of their fluxes."""

import math
from dataclasses import replace

import numpy as np
import pytest

from tests.extraction.fields import OPTIONS, field_of, pair
from uvshear.constants import ARCSEC
from uvshear.extraction import Model
from uvshear.extraction.converged.modelled_field import (
    ASTROMETRY,
    PHOTOMETRY,
    SUREST_PHOTOMETRY,
    ModelledField,
)
from uvshear.extraction.converged.sources import GalaxySource, PointSource
from uvshear.interferometer.attenuation import total_attenuation
from uvshear.shapes.measurement import FitFlag

DECLINATION = 0.7


@pytest.fixture(scope="module")
def field():
    observation, catalogue, _ = pair()
    return field_of(observation, catalogue)


def _modelled(field, model=OPTIONS.model):
    return ModelledField.from_field(field, model, DECLINATION)


def test_sources_are_expected_to_be_round_and_of_the_catalogues_flux(field):
    modelled = _modelled(field)
    assert [fit.flux for fit in modelled.expected] == pytest.approx([2e-3, 1.5e-3])
    assert all(fit.ellipticity == 0 for fit in modelled.expected)
    assert all(isinstance(source, GalaxySource) for source in modelled.sources)
    assert modelled.galaxies == [0, 1]


def test_a_point_is_subtracted_and_not_measured(field):
    flags = field.flags.copy()
    flags[1] = FitFlag.POINT_SOURCE
    modelled = _modelled(replace(field, flags=flags))
    assert isinstance(modelled.sources[1], PointSource)
    assert modelled.galaxies == [0]


def test_what_the_catalogue_does_not_tell_has_usual_errors(field):
    prior = _modelled(field).sources[0].prior
    assert prior.flux_sigma == pytest.approx(PHOTOMETRY * 2e-3)
    assert prior.position_sigma == pytest.approx(ASTROMETRY * math.exp(prior.log_scale_length))
    variance = OPTIONS.model.population.population_variance
    assert prior.ellipticity_sigma == pytest.approx(math.sqrt(variance))


def test_the_smallest_numbers_of_a_catalogue_do_not_overflow(field):
    flux = np.array([1e-300, 1.5e-3])
    tiny = replace(
        field, sky=replace(field.sky, flux=flux), position_err=np.array([1e-300, 1e-200])
    )
    for source in _modelled(tiny).sources:
        pull, precision = source.prior.pull(source.expected)
        assert np.isfinite([*pull, *precision, source.prior.penalty(source.expected)]).all()
        assert (1 / source.prior.flux_sigma) ** 2 < 1e100


def test_errors_of_the_catalogue_are_taken_and_not_believed_to_be_tiny(field):
    told = replace(field, flux_err=np.array([2e-4, 1e-9]), position_err=np.full(2, 0.1 * ARCSEC))
    priors = [source.prior for source in _modelled(told).sources]
    assert priors[0].flux_sigma == pytest.approx(2e-4)
    assert priors[1].flux_sigma == pytest.approx(SUREST_PHOTOMETRY * 1.5e-3)
    assert priors[0].position_sigma == pytest.approx(0.1 * ARCSEC)
    given = _modelled(told, replace(OPTIONS.model, position_radius=3 * ARCSEC))
    assert given.sources[0].prior.position_sigma == pytest.approx(1.5 * ARCSEC)


def test_fits_go_back_into_the_catalogues_sky(field):
    steep = replace(field.sky, spectral_index=np.array([-0.7, -1.5]))
    modelled = _modelled(replace(field, sky=steep), Model(smears=False))
    assert total_attenuation(DECLINATION, None, smears=False) is None
    fits = [replace(fit, ellipticity=0.2j) for fit in modelled.expected]
    sky = modelled.sky(fits)
    np.testing.assert_allclose(sky.flux, field.sky.flux)
    np.testing.assert_array_equal(sky.ellipticity, [0.2j, 0.2j])
    assert modelled.in_catalogue_flux(1, fits[1]).flux == pytest.approx(1.5e-3)
    # Both are at 1.4 GHz, one channel: the second has the same strength but for the common spectrum.
    np.testing.assert_allclose(modelled.strength_at_1_4_ghz, modelled.strength)
