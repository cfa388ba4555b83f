import galsim
import numpy as np
import pytest
import treecorr
from astropy import units
from astropy.coordinates import SkyCoord
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from uvshear.geometry.directions import PhaseCentre, equatorial, local_north
from uvshear.geometry.ellipticity import (
    add_shear,
    lensing_components,
    position_angle,
    quadratic_form,
    quadratic_form_derivatives,
    quadratic_form_of,
    rotate,
    sheared_scale_length,
    to_field_frame,
    to_local_north,
)

DISC = st.builds(lambda r, t: r * np.exp(1j * t), st.floats(0, 0.95), st.floats(0, 2 * np.pi))


def ellipticities(size=3):
    return st.lists(DISC, min_size=size, max_size=size).map(np.array)


def transfer(e):
    return np.array([[1 - e.real, -e.imag], [-e.imag, 1 + e.real]])


@given(ellipticities(), DISC)
def test_shear_adds_as_galsim_adds(e, g):
    expected = [
        (galsim.Shear(g1=g.real, g2=g.imag) + galsim.Shear(g1=x.real, g2=x.imag)).shear for x in e
    ]
    np.testing.assert_allclose(add_shear(e, g), expected, rtol=0, atol=1e-12)


@given(ellipticities(), DISC)
def test_shear_stays_in_the_unit_disc_and_is_undone_by_its_opposite(e, g):
    sheared = add_shear(e, g)
    assert np.all(np.abs(sheared) < 1)
    np.testing.assert_allclose(add_shear(sheared, -g), e, rtol=0, atol=1e-10)


@given(ellipticities(), DISC, st.floats(-4, 4))
def test_rotation_commutes_with_shear(e, g, angle):
    turned = add_shear(rotate(e, angle), g * np.exp(2j * angle))
    np.testing.assert_allclose(turned, rotate(add_shear(e, g), angle), rtol=0, atol=1e-10)


@given(
    ellipticities(),
    arrays(float, 3, elements=st.floats(0.1, 9)),
    arrays(float, (2, 3), elements=st.floats(-9, 9)),
)
def test_quadratic_form_is_the_matrix_product_of_the_paper(e, scale_length, k):
    a, b, c = quadratic_form(e, scale_length)
    u, v = k
    got = a * u**2 + b * u * v + c * v**2
    for i in range(3):
        y = scale_length[i] * np.linalg.inv(transfer(e[i])).T @ k[:, i]
        np.testing.assert_allclose(got[i], y @ y, rtol=1e-9, atol=1e-9)


@given(ellipticities(), DISC)
def test_sheared_scale_length_is_the_linear_map_of_the_sky(e, g):
    # isophotes |A x| = alpha; a map M of unit determinant makes them |A M^-1 x| = alpha
    scale_length = np.array([0.3, 1.0, 2.0])
    sheared = add_shear(e, g)
    a, b, c = quadratic_form(sheared, sheared_scale_length(scale_length, e, sheared))
    inverse_map = transfer(g) / np.sqrt(1 - abs(g) ** 2)
    for i in range(3):
        B = transfer(e[i]) @ inverse_map / scale_length[i]
        form = np.linalg.inv(B.T @ B)
        got = np.array([[a[i], b[i] / 2], [b[i] / 2, c[i]]])
        np.testing.assert_allclose(got, form, rtol=0, atol=1e-9 * np.abs(form).max())


@given(ellipticities(), DISC)
def test_scale_length_comes_back_with_the_opposite_shear(e, g):
    scale_length = np.ones(3)
    sheared = add_shear(e, g)
    there = sheared_scale_length(scale_length, e, sheared)
    back = sheared_scale_length(there, sheared, add_shear(sheared, -g))
    np.testing.assert_allclose(back, 1, rtol=1e-10)


def test_the_axes_of_the_convention():
    e = np.array([0.3, 0.3j, -0.3, -0.3j])  # long along l, along l = m, along m, along l = -m
    np.testing.assert_allclose(np.degrees(position_angle(e)), [90, 45, 0, 135], atol=1e-12)
    np.testing.assert_allclose(rotate(e, np.pi / 4), np.roll(e, -1), atol=1e-15)


def test_position_angle_stays_below_half_a_turn():
    e = np.array([-0.3 + 0j, -0.3 + 1e-18j, -0.3 - 1e-18j, 0j])
    angle = position_angle(e)
    assert np.all((angle >= 0) & (angle < np.pi))


@pytest.mark.parametrize("dec", [80.0, -30.0, -90.0])
def test_position_angle_is_that_of_astropy_along_the_long_axis(dec):
    centre = PhaseCentre(0.2, np.radians(dec))
    rng = np.random.default_rng(3)
    l, m = rng.uniform(-0.012, 0.012, (2, 40))
    e = 0.4 * np.exp(2j * rng.uniform(0, np.pi, 40))
    along = np.exp(0.5j * np.angle(e))  # the long axis, l + i m
    step = 1e-6
    first = SkyCoord(*equatorial(centre, l, m) * units.rad)
    second = SkyCoord(*equatorial(centre, l + step * along.real, m + step * along.imag) * units.rad)
    got = position_angle(to_local_north(e, local_north(centre, l, m)))
    difference = np.angle(np.exp(2j * (got - first.position_angle(second).rad))) / 2
    # measured 3.6e-5, the projection's foreshortening; a wrong rotation: 0.07 to 1.5
    assert np.abs(difference).max() < 8e-5


@pytest.mark.parametrize("dec", [80.0, -30.0, -90.0, 0.0])
def test_the_field_frame_undoes_the_sky_frame(dec):
    centre = PhaseCentre(0.2, np.radians(dec))
    rng = np.random.default_rng(7)
    l, m = rng.uniform(-0.02, 0.02, (2, 50))
    e = rng.uniform(0, 0.9, 50) * np.exp(2j * rng.uniform(0, np.pi, 50))
    psi = local_north(centre, l, m)
    g1, g2 = lensing_components(to_local_north(e, psi))
    np.testing.assert_allclose(to_field_frame(g1 + 1j * g2, psi), e, atol=1e-15)


def test_at_the_phase_centre_the_frames_differ_by_the_sign_of_the_second_component():
    assert to_field_frame(np.array([0.1 + 0.2j]), 0.0)[0] == 0.1 - 0.2j


def test_treecorr_finds_the_tangential_shear_put_around_a_lens():
    # The lens lies 0.6 degrees East at declination 80, where local North is 0.06 rad from m.
    centre, lens = PhaseCentre(np.radians(30), np.radians(80)), 0.0105 + 0.002j
    rng = np.random.default_rng(5)
    offset = rng.uniform(2e-4, 2e-3, 4000) * np.exp(2j * np.pi * rng.uniform(0, 1, 4000))
    gamma_t = 0.05
    e = -gamma_t * (offset / np.abs(offset)) ** 2  # long axis across the line to the lens
    l, m = (lens + offset).real, (lens + offset).imag
    ra, dec = equatorial(centre, l, m)
    g1, g2 = lensing_components(to_local_north(e, local_north(centre, l, m)))
    lens_ra, lens_dec = equatorial(centre, np.array([lens.real]), np.array([lens.imag]))
    units_of_angle = {"ra_units": "rad", "dec_units": "rad"}
    sources = treecorr.Catalog(ra=ra, dec=dec, g1=g1, g2=g2, **units_of_angle)
    lenses = treecorr.Catalog(ra=lens_ra, dec=lens_dec, **units_of_angle)
    correlation = treecorr.NGCorrelation(
        min_sep=1e-4, max_sep=3e-3, nbins=4, sep_units="rad", brute=True
    )
    correlation.process(lenses, sources, num_threads=1)
    filled = correlation.npairs > 0
    # measured 2e-5 gamma_t; unrotated axes leave xi_im = 0.12 gamma_t, a wrong sign of g2 xi = 0
    np.testing.assert_allclose(correlation.xi[filled], gamma_t, rtol=2e-4)
    np.testing.assert_allclose(correlation.xi_im[filled], 0, atol=2e-4 * gamma_t)


@pytest.mark.parametrize("e", [0j, 0.3 - 0.2j, -0.7 + 0.4j])
def test_the_form_of_one_galaxy_and_its_derivatives_are_those_of_many(e):
    def form(de=0j, larger=0.0):
        return np.array(quadratic_form(np.array([e + de]), np.array([2.0 * np.exp(larger)])))[:, 0]

    np.testing.assert_allclose(quadratic_form_of(e, 2.0), form(), rtol=1e-14)
    step = 1e-6
    differences = [
        (form(step) - form(-step)) / (2 * step),
        (form(1j * step) - form(-1j * step)) / (2 * step),
        (form(larger=step) - form(larger=-step)) / (2 * step),
    ]
    np.testing.assert_allclose(
        quadratic_form_derivatives(e, 2.0), differences, rtol=1e-8, atol=1e-8
    )
