"""One test a line of docs/conventions.md that no test of a module holds."""

from dataclasses import replace

import numpy as np
import pytest

from tests.reference import direct_sum, dirty
from tests.skies import L_BAND, galaxies, random_baselines
from uvshear.constants import ARCSEC, REFERENCE_FREQUENCY, SPECTRAL_INDEX, SPEED_OF_LIGHT
from uvshear.extraction import Model
from uvshear.galaxy import DiscEllipticityPrior, FlatEllipticityPrior
from uvshear.geometry.directions import PhaseCentre
from uvshear.geometry.ellipticity import add_shear, sheared_scale_length
from uvshear.interferometer.coverage import Track, synthesise
from uvshear.interferometer.layout import load_layout
from uvshear.interferometer.stokes import stokes_i
from uvshear.io.catalogue import catalogue_from_table
from uvshear.predict import predict_visibilities

WAVELENGTH = SPEED_OF_LIGHT / L_BAND[0]


def test_data_turn_by_plus_2_pi_i():
    """A source l = 1e-3 to the East on one baseline of u = 100 wavelengths: a tenth of a turn ahead."""
    for uvw, l, m, turns in [
        ((100, 0, 0), 1e-3, 0.0, 0.1),
        ((0, 100, 0), 0.0, 1e-3, 0.1),
        ((0, 0, 1e5), 1e-3, 0.0, -0.05),  # n - 1 = -5e-7
    ]:
        sky = galaxies(l, m, alpha=0.0)
        vis = predict_visibilities(sky, np.array([uvw]) * WAVELENGTH, L_BAND)[0, 0]
        assert vis == pytest.approx(np.exp(2j * np.pi * turns), abs=1e-6)


def test_uvw_points_from_antenna_2_to_antenna_1():
    centre = PhaseCentre(1.0, 0.6)
    layout = load_layout("vla-b")
    coverage = synthesise(layout, Track(centre, ((-0.001, 0.001),), 10.0))
    first, second = (layout.positions[a] for a in (coverage.antenna1, coverage.antenna2))
    east = np.array([-np.sin(layout.longitude), np.cos(layout.longitude), 0.0])
    # at transit u is the distance to the East: X(ANTENNA1) - X(ANTENNA2)
    u = (first - second) @ east
    np.testing.assert_allclose(
        coverage.uvw[: len(u), 0], u, rtol=0, atol=20.0
    )  # of 11 km; hour angle 3e-4
    assert np.corrcoef(coverage.uvw[: len(u), 0], u)[0, 1] > 0.9999


def _second_moments(e, alpha=3 * ARCSEC):
    """Axes of a Gaussian fitted to the dirty image of a galaxy before a dense array."""
    uvw = random_baselines(4000, 6e3, depth=0.0)
    vis = predict_visibilities(galaxies(alpha=alpha, e=e), uvw, L_BAND)
    # weights proportional to radius make the density uniform
    weights = np.hypot(uvw[:, 0], uvw[:, 1])[:, None]
    x = np.linspace(-9, 9, 41) * ARCSEC
    l, m = np.meshgrid(x, x, indexing="ij")
    image = dirty.dirty_image(uvw, L_BAND, vis, weights, l, m)
    core = np.where(image > 0.3 * image.max(), image, 0)
    return np.array([[np.sum(core * a * b) for b in (l, m)] for a in (l, m)]) / core.sum()


@pytest.mark.parametrize(
    ("e", "angle"), [(0.4, 0.0), (-0.4, 90.0), (0.4j, 45.0), (-0.4j, 135.0), (0.4 + 0.4j, 22.5)]
)
def test_the_long_axis_lies_along_half_the_argument_of_e(e, angle):
    values, vectors = np.linalg.eigh(_second_moments(e))
    long = np.degrees(np.arctan2(vectors[1, 1], vectors[0, 1])) % 180
    assert abs((long - angle + 90) % 180 - 90) < 3  # measured 1.4
    assert values[1] > 1.5 * values[0]


def test_the_modulus_of_e_is_the_difference_of_the_axes_over_their_sum():
    """a, b from the brightness itself: half the flux lies within the ellipse 1.678 alpha (a, b)/alpha."""
    e, alpha = 0.3 + 0.4j, 2.0
    l, m, flux = direct_sum.brightness_samples(e, alpha)
    q = np.array([[np.sum(flux * a * b) for b in (l, m)] for a in (l, m)])
    b, a = np.sqrt(np.linalg.eigvalsh(q))
    assert (a - b) / (a + b) == pytest.approx(0.5, rel=1e-9)
    # second moment of exp(-r/alpha) along an axis: 3 alpha^2; the axes are alpha/(1 -+ |e|)
    assert a == pytest.approx(np.sqrt(3) * alpha / (1 - 0.5), rel=1e-6)
    assert b == pytest.approx(np.sqrt(3) * alpha / (1 + 0.5), rel=1e-6)
    centred = np.sqrt((q[1, 1] * l**2 - 2 * q[0, 1] * l * m + q[0, 0] * m**2) / np.linalg.det(q))
    inner = np.sum(flux[centred < 1.67835 / np.sqrt(3)])
    assert inner == pytest.approx(0.5, abs=0.01)


def test_shear_is_a_linear_map_of_the_sky():
    """Coordinates x -> M x with M = [[1+g1, g2], [g2, 1-g1]]/sqrt(1-|g|^2): visibilities at M^T k."""
    g, e, alpha = 0.08 - 0.05j, 0.3 + 0.2j, 2 * ARCSEC
    uvw = random_baselines(50, 5e3, depth=0.0)
    sheared = add_shear(np.array([e]), g)
    larger = sheared_scale_length(np.array([alpha]), np.array([e]), sheared)
    after = predict_visibilities(galaxies(alpha=larger, e=sheared), uvw, L_BAND)
    matrix = np.array([[1 + g.real, g.imag], [g.imag, 1 - g.real]]) / np.sqrt(1 - abs(g) ** 2)
    mapped = np.column_stack([uvw[:, :2] @ matrix, uvw[:, 2]])
    before = predict_visibilities(galaxies(alpha=alpha, e=e), mapped, L_BAND)
    np.testing.assert_allclose(after, before, rtol=1e-10)  # alpha left alone: 1e-2
    alone = predict_visibilities(galaxies(alpha=alpha, e=sheared), uvw, L_BAND)
    assert np.abs(alone - before).max() > 1e-3


def test_the_weight_of_stokes_i_is_four_over_the_sum_of_variances():
    w = np.array([[[3.0, 5.0]]])
    combined = stokes_i(np.ones((1, 1, 2), complex), w, np.zeros((1, 1, 2), bool))
    assert combined.weights[0, 0] == pytest.approx(4 / (1 / 3 + 1 / 5))


def test_sigma_is_that_of_one_real_component():
    """A point source's flux measured from N visibilities of weight w has the variance 1/(N w)."""
    rng = np.random.default_rng(2)
    sigma, number = 0.3, 400
    noise = sigma * rng.normal(size=(2, 2000, number))
    fluxes = np.mean(noise[0], axis=1)  # <d, m>/<m, m> for m = 1
    assert fluxes.std() == pytest.approx(1 / np.sqrt(number / sigma**2), rel=0.06)
    # <d, d> = sum w |d|^2 counts two components: 2 N
    vis = noise[0, 0] + 1j * noise[1, 0]
    chi2 = dirty.inner(np.full(number, sigma**-2), vis, vis)
    assert chi2 == pytest.approx(2 * number, rel=0.15)


def test_fluxes_are_at_1_4_ghz_with_index_minus_0_7_unless_told():
    from astropy import units
    from astropy.table import QTable

    table = QTable({"id": [1], "flux": [1] * units.Jy, "l": [0.0], "m": [0.0]})
    catalogue = catalogue_from_table(table)
    assert REFERENCE_FREQUENCY == catalogue.reference_frequency == 1.4e9
    assert SPECTRAL_INDEX == catalogue.spectral_index[0] == -0.7


def test_the_prior_of_the_posterior_mean_is_flat_unless_told():
    model = Model()
    assert model.ellipticity == FlatEllipticityPrior(0.95)
    assert model.population == DiscEllipticityPrior()


def test_the_envelope_knows_no_order_of_conjugate_baselines():
    """Hermitian: V(-k) is the conjugate of V(k)."""
    uvw = random_baselines(20, 5e3)
    sky = galaxies(0.004, -0.003, e=0.3 + 0.2j)
    there, back = (predict_visibilities(sky, sign * uvw, L_BAND) for sign in (1, -1))
    np.testing.assert_allclose(there, back.conj(), rtol=0, atol=1e-12)
    turned = replace(sky, ellipticity=-sky.ellipticity)
    assert not np.allclose(predict_visibilities(turned, uvw, L_BAND), there, atol=1e-3)
