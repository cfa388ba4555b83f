"""Priors, first sky and flags of the sources of a catalogue."""

from dataclasses import replace

import numpy as np
import pytest

from tests.pipeline.fields import METHOD, MODEL
from uvshear.constants import ARCSEC
from uvshear.errors import InputError
from uvshear.extraction import Model
from uvshear.interferometer.primary_beam import AiryBeam
from uvshear.interferometer.summary import summarise
from uvshear.interferometer.uv_range import UvRange
from uvshear.pipeline.field import field_of_catalogue


@pytest.fixture(scope="module")
def summary(field):
    return summarise(field.observation)


def _field(field, summary, catalogue=None, model=MODEL, method=METHOD):
    catalogue = field.catalogue if catalogue is None else catalogue
    return field_of_catalogue(catalogue, field.observation.phase_centre, summary, model, method)


def _words(found):
    return [flag.word for flag in found.flags]


def test_the_first_sky_is_round_and_of_the_catalogue_s_fluxes(field, summary):
    found = _field(field, summary)
    assert _words(found)[4] == "outside_field"
    assert _words(found)[6] == "below_horizon"
    assert found.modelled.tolist() == [0, 1, 2, 3, 5]
    assert not found.sky.ellipticity.any()
    np.testing.assert_array_equal(found.sky.flux[found.modelled], field.truth.flux[found.modelled])
    assert not found.sky.flux[[4, 6]].any()


def test_a_point_source_is_modelled_as_a_point(field, summary):
    found = _field(field, summary)
    assert _words(found)[1] == "point_source"
    assert found.sky.scale_length[1] == 0
    assert np.isfinite(found.size.log_median[1])


@pytest.mark.parametrize(("apart", "word"), [(0.2, "duplicate"), (0.3, "ok")])
def test_the_fainter_of_two_sources_at_one_place_is_a_duplicate(field, summary, apart, word):
    near = field.catalogue.select(np.array([0, 0]))
    l, m, _ = near.directions(field.observation.phase_centre)
    size = np.full(2, 2 * ARCSEC)
    near = replace(
        near,
        ra=None,
        dec=None,
        l=l + np.array([0, apart]) * size,
        m=m,
        flux=np.array([2e-3, 1e-3]),
        scale_length=size,
        identifier=np.array([1, 2]),
    )
    found = _field(field, summary, near)
    assert _words(found) == ["ok", word]
    assert found.modelled.tolist() == ([0] if word == "duplicate" else [0, 1])


def test_a_source_that_the_dishes_do_not_see_is_outside_the_field(field, summary):
    """A dish of a kilometre has its first null 0.9 arcmin from the axis, within this field."""
    narrow = replace(MODEL, primary_beam=AiryBeam.from_diameters(np.full(27, 1000.0)))
    found = _field(field, summary, model=narrow)
    assert _words(found)[0] == "ok"
    assert "outside_field" in _words(found)[:4]


def test_a_range_without_baselines_is_refused(field, summary):
    with pytest.raises(InputError, match=r"--uv-min 1e\+09 \(uv_range=\): the longest baseline"):
        _field(field, summary, method=replace(METHOD, uv_range=UvRange(1e9)))


@pytest.mark.parametrize("index", [-100.0, -6.0, -4.0, 4.0, 12.0, 100.0])
def test_a_wild_spectrum_gives_no_wild_size(field, summary, index):
    """Fluxes at 150 MHz, with indices that fits to a few channels give, are ten times from 1.4 GHz."""
    catalogue = replace(
        field.catalogue,
        scale_length=None,
        spectral_index=np.full(len(field.catalogue), index),
        reference_frequency=1.3e9,
    )
    found = _field(field, summary, catalogue, Model())
    usual = _field(
        field,
        summary,
        replace(catalogue, spectral_index=np.full(len(catalogue), np.sign(index) * 4)),
        Model(),
    )
    within = np.abs(index) <= 4
    assert within or np.array_equal(found.size.log_median, usual.size.log_median)
    assert np.all(np.exp(found.size.log_median) < 60 * ARCSEC)


def test_a_spectrum_that_gives_an_absurd_flux_in_the_band_is_refused(field, summary):
    index = np.full(len(field.catalogue), -0.7)
    index[3] = -60.0
    wild = replace(field.catalogue, spectral_index=index, reference_frequency=1e9)
    with pytest.raises(InputError, match=r"id s3: with the spectral index -60, .* is 1e-10 times"):
        _field(field, summary, wild)
