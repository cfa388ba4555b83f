import numpy as np
import pytest
from astropy import units
from astropy.coordinates import SkyCoord
from astropy.wcs import WCS

from uvshear.geometry.directions import (
    PhaseCentre,
    direction_cosines,
    equatorial,
    local_north,
    n_minus_one,
)

CENTRES = [
    PhaseCentre(np.radians(ra), np.radians(dec))
    for ra, dec in [(0.1, 80.0), (123.4, -30.0), (359.9, 0.0), (45.0, -90.0), (200.0, 90.0)]
]
FIELD = np.radians(0.7)


def directions_of_the_field():
    angle = np.linspace(0.05, 2 * np.pi, 24, endpoint=False)
    radius = np.linspace(0.02, 1, 24) * FIELD
    return radius * np.cos(angle), radius * np.sin(angle)


def sky(ra, dec):
    return SkyCoord(ra * units.rad, dec * units.rad)


def apart(angle, other):
    return np.abs(np.angle(np.exp(1j * (angle - other))))


def test_n_minus_one_keeps_its_digits_near_the_phase_centre():
    l, m = np.array([3e-9, 0.3]), np.array([4e-9, 0.4])
    np.testing.assert_allclose(
        n_minus_one(l, m), [-1.25e-17, np.sqrt(0.75) - 1], rtol=1e-14, atol=0
    )


@pytest.mark.parametrize("centre", CENTRES)
def test_direction_cosines_are_the_sin_projection_of_wcslib(centre):
    wcs = WCS(naxis=2)
    wcs.wcs.ctype = ["RA---SIN", "DEC--SIN"]
    wcs.wcs.crval = np.degrees([centre.ra, centre.dec])
    wcs.wcs.cdelt = [1.0, 1.0]  # l grows with RA, to the East
    wcs.wcs.lonpole = 180  # FITS turns the axes by half a turn at dec +90 unless told
    l, m = directions_of_the_field()
    ra, dec = np.radians(wcs.wcs_pix2world(np.degrees(l), np.degrees(m), 1))
    got_l, got_m, got_n = direction_cosines(centre, ra, dec)
    # measured 1e-15; wrong axes or signs: 1e-2
    np.testing.assert_allclose(got_l, l, rtol=0, atol=1e-14)
    np.testing.assert_allclose(got_m, m, rtol=0, atol=1e-14)
    np.testing.assert_allclose(got_n, 1 + n_minus_one(l, m), rtol=0, atol=1e-14)
    got_ra, got_dec = equatorial(centre, l, m)
    assert (apart(got_ra, ra) * np.cos(dec)).max() < 1e-14
    np.testing.assert_allclose(got_dec, dec, rtol=0, atol=1e-14)


@pytest.mark.parametrize("centre", CENTRES)
def test_astropys_separation_and_bearing_are_those_of_the_cosines(centre):
    l, m = directions_of_the_field()
    target, origin = sky(*equatorial(centre, l, m)), sky(centre.ra, centre.dec)
    np.testing.assert_allclose(
        np.sin(origin.separation(target).rad), np.hypot(l, m), rtol=0, atol=1e-12
    )
    assert apart(origin.position_angle(target).rad, np.arctan2(l, m)).max() < 1e-10


def test_right_ascension_wraps_into_one_turn():
    centre = PhaseCentre(1e-4, 0.3)
    ra, _ = equatorial(centre, np.array([-0.01, 0.0, 0.01]), np.zeros(3))
    assert np.all((ra >= 0) & (ra < 2 * np.pi))
    assert ra[0] > 6
    l, _, _ = direction_cosines(centre, ra, np.full(3, 0.3))
    np.testing.assert_allclose(
        l, direction_cosines(centre, ra - 2 * np.pi, np.full(3, 0.3))[0], rtol=0, atol=1e-15
    )
    ra, _ = equatorial(PhaseCentre(0.0, 0.3), np.array([-1e-18]), np.zeros(1))
    assert ra[0] < 2 * np.pi


def test_a_direction_behind_has_negative_n():
    centre = PhaseCentre(1.0, -0.5)
    ra = np.array([1.0, 1.0 + np.pi, 1.0 + np.pi])
    dec = np.array([-0.5, 0.5, 0.1])
    n = direction_cosines(centre, ra, dec)[2]
    np.testing.assert_allclose(n[:2], [1, -1], rtol=1e-15)
    assert n[2] < 0


@pytest.mark.parametrize("centre", CENTRES)
def test_local_north_is_the_turn_of_astropys_position_angle_along_a_great_circle(centre):
    l, m = directions_of_the_field()
    target, origin = sky(*equatorial(centre, l, m)), sky(centre.ra, centre.dec)
    outward = target.position_angle(origin).rad + np.pi
    psi = local_north(centre, l, m)
    # measured 6e-13; a wrong sign: 0.1 at dec 80
    assert apart(psi, np.arctan2(l, m) - outward).max() < 1e-10


def test_local_north_differs_from_the_projected_meridian_by_foreshortening_alone():
    centre, step = PhaseCentre(0.3, np.radians(80)), 1e-4
    l, m = directions_of_the_field()
    ra, dec = equatorial(centre, l, m)
    north = np.subtract(
        direction_cosines(centre, ra, dec + step)[:2], direction_cosines(centre, ra, dec - step)[:2]
    )
    psi = local_north(centre, l, m)
    difference = apart(psi, np.arctan2(north[0], north[1]))
    # measured 3.6e-5 = (1 - n)/2; psi itself reaches 0.07
    assert difference.max() < 4e-5
    assert np.abs(psi).max() > 0.06
    assert psi[np.argmax(l)] < 0  # East of the centre, the northern pole lies to the West of m
