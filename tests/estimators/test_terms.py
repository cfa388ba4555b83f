"""Terms of the sums, and their turn to the frame of the sky."""

import numpy as np
import pytest
import treecorr

from uvshear.estimators.terms import Terms, shear_in_field_frame
from uvshear.geometry.directions import PhaseCentre, equatorial, local_north
from uvshear.geometry.ellipticity import lensing_components, to_local_north

RNG = np.random.default_rng(6)


def _random(number=7):
    return Terms(RNG.normal(size=(number, 2)), RNG.normal(size=(number, 2, 2)))


def test_values_in_the_frame_of_the_sky_are_those_of_the_ellipticities():
    terms, psi = _random(), RNG.uniform(-np.pi, np.pi, 7)
    local = to_local_north(terms.value[:, 0] + 1j * terms.value[:, 1], psi)
    got = terms.in_sky_frame(psi).value
    np.testing.assert_allclose(got, np.stack(lensing_components(local), axis=-1), atol=1e-14)


def test_numbers_of_a_turn_by_thirty_degrees():
    """e = 0.2 along l; local North is 30 degrees East of m, and the sky frame has East to the left."""
    terms = Terms(np.array([[0.2, 0.0]]), np.array([[[1.0, 0.0], [0.0, 0.5]]]))
    got = terms.in_sky_frame(np.array([np.pi / 6]))
    np.testing.assert_allclose(got.value, [[0.1, -0.2 * np.sqrt(3) / 2]], atol=1e-15)
    # T diag(1, 0.5) T with T = ((1/2, -sqrt(3)/2), (-sqrt(3)/2, -1/2))
    mixed = -np.sqrt(3) / 4 + 0.5 * np.sqrt(3) / 4
    expected = [[[0.25 + 0.5 * 0.75, mixed], [mixed, 0.75 + 0.5 * 0.25]]]
    np.testing.assert_allclose(got.response, expected, atol=1e-15)


def test_a_response_turns_with_the_shear():
    """R g, turned to the frame of the sky, is the turned R times the shear of that frame."""
    g, psi = 0.03 - 0.02j, RNG.uniform(-np.pi, np.pi, 7)
    local = shear_in_field_frame(g, psi)
    response = RNG.normal(size=(7, 2, 2))
    value = np.einsum("sij,sj->si", response, np.stack([local.real, local.imag], axis=-1))
    turned = Terms(value, response).in_sky_frame(psi)
    np.testing.assert_allclose(turned.value, turned.response @ np.array([g.real, g.imag]))


def test_a_turn_is_its_own_inverse():
    terms, psi = _random(), RNG.uniform(-np.pi, np.pi, 7)
    again = terms.in_sky_frame(psi).in_sky_frame(psi)
    np.testing.assert_allclose(again.value, terms.value, atol=1e-14)
    np.testing.assert_allclose(again.response, terms.response, atol=1e-14)


def test_the_frame_of_the_sky_is_that_of_treecorr():
    """A source at declination 80 deg, 1.2 deg off the centre, long across the line to a lens beside it: tangential."""
    centre = PhaseCentre(1.0, np.radians(80.0))
    lens, offset = 0.018 + 0.011j, 4e-4 * np.exp(0.7j)
    e = -0.05 * (offset / abs(offset)) ** 2
    source = lens + offset
    l, m = np.array([source.real]), np.array([source.imag])
    psi = local_north(centre, l, m)
    assert abs(psi[0]) > 0.09
    terms = Terms(np.array([[e.real, e.imag]]), np.eye(2)[None]).in_sky_frame(psi)
    places = [np.array(part) for part in zip((lens.real, lens.imag), (l[0], m[0]), strict=True)]
    (lens_ra, ra), (lens_dec, dec) = equatorial(centre, *places)
    units = {"ra_units": "rad", "dec_units": "rad"}
    sources = treecorr.Catalog(
        ra=[ra], dec=[dec], g1=terms.value[:, 0], g2=terms.value[:, 1], **units
    )
    lenses = treecorr.Catalog(ra=[lens_ra], dec=[lens_dec], **units)
    found = treecorr.NGCorrelation(min_sep=1e-4, max_sep=1e-3, nbins=1, sep_units="rad", brute=True)
    found.process(lenses, sources, num_threads=1)
    # the projection's compression, 2e-4 of the offset, turns the line a little
    assert found.xi[0] == pytest.approx(0.05, rel=1e-5)
    assert found.xi_im[0] == pytest.approx(0.0, abs=2e-5)


def test_a_source_tells_where_all_numbers_are_known_and_some_response_is_there():
    value, response = np.ones((4, 2)), np.tile(np.eye(2), (4, 1, 1))
    value[1, 0] = np.nan
    response[2] = 0
    response[3, 0, 1] = np.inf
    assert Terms(value, response).tells.tolist() == [True, False, False, False]


def test_weights_count_sources():
    terms = _random(10)
    twice = terms.weighted(np.array([2.0] + [1.0] * 9))
    np.testing.assert_array_equal(twice.value[0], 2 * terms.value[0])
    np.testing.assert_array_equal(twice.response[1:], terms.response[1:])


def test_parts_are_joined_in_their_order():
    terms = _random(10)
    parts = [terms.select(np.arange(first, min(first + 4, 10))) for first in (0, 4, 8)]
    joined = Terms.joined(parts)
    np.testing.assert_array_equal(joined.value, terms.value)
    np.testing.assert_array_equal(joined.response, terms.response)
    assert len(Terms.joined([])) == 0
