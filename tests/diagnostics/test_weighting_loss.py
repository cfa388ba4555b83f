import math
from dataclasses import replace

import numpy as np
import pytest

from uvshear.constants import ARCSEC, SPEED_OF_LIGHT
from uvshear.diagnostics.psf import point_spread_function
from uvshear.diagnostics.weighting_loss import weighting_loss
from uvshear.errors import InputError
from uvshear.execution import in_threads
from uvshear.galaxy import Exponential
from uvshear.geometry.directions import PhaseCentre
from uvshear.geometry.ellipticity import quadratic_form
from uvshear.imaging import ImageGrid
from uvshear.interferometer.coverage import Track, synthesise
from uvshear.interferometer.layout import load_layout
from uvshear.interferometer.psf_shape import fit_main_lobe, measure_psf
from uvshear.interferometer.visibilities import Visibilities, VisibilitySet
from uvshear.interferometer.weighting import GaussianTaper, RoundPsf, weighted

ALPHA = 1.5 * ARCSEC
FREQUENCY = np.array([1.07e9])


def _observation(rows: int = 3000) -> VisibilitySet:
    rng = np.random.default_rng(8)
    uvw = rng.normal(0, (12e3, 7e3, 1e2), (rows, 3))
    weights = rng.uniform(0.5, 2, (rows, 1))
    block = Visibilities(uvw, FREQUENCY, np.ones((rows, 1), complex), weights)
    return VisibilitySet(PhaseCentre(0.0, 0.0), (block,))


def _model(u: np.ndarray, v: np.ndarray, flux: float, e: complex, alpha: float) -> np.ndarray:
    a, b, c = np.array(quadratic_form(np.array([e]), np.array([alpha])))[:, 0]
    return flux * (1 + 4 * math.pi**2 * (a * u * u + b * u * v + c * v * v)) ** -1.5


def _derivatives(observation: VisibilitySet) -> tuple[np.ndarray, np.ndarray]:
    """Numerically, by flux, e1, e2 and the logarithm of the scale length; and the weights."""
    (seen,) = observation.chunks()
    u, v = seen.uvw[:, :2].T * FREQUENCY / SPEED_OF_LIGHT
    h = 1e-5
    steps = [(h, 0j, 0), (0, h + 0j, 0), (0, h * 1j, 0), (0, 0j, h)]
    sides = [
        [_model(u, v, 1 + s * df, s * de, ALPHA * math.exp(s * da)) for s in (1, -1)]
        for df, de, da in steps
    ]
    return np.array([(ahead - behind) / (2 * h) for ahead, behind in sides]), seen.weights[:, 0]


def test_the_loss_is_that_of_least_squares_with_the_wrong_weights() -> None:
    """Scatter of what weighted least squares makes of noise, against the best weights."""
    observation = _observation()
    tapered = weighted(observation, (GaussianTaper(3 * ARCSEC), RoundPsf()))
    loss = weighting_loss(tapered.map_baselines(), ALPHA, Exponential())
    derivatives, weight = _derivatives(observation)
    (seen,) = tapered.chunks()
    rng = np.random.default_rng(2)
    noise = rng.normal(size=(4000, len(weight))) / np.sqrt(weight)
    found = []
    for used in (weight, seen.weights[:, 0]):
        by_beam = np.linalg.inv((derivatives * used) @ derivatives.T)
        found.append(noise @ (by_beam @ (derivatives * used)).T)
    best, ours = (np.var(one, axis=0)[1:3] for one in found)
    # 4000 draws of the same noise: the ratio is good to 2 per cent
    np.testing.assert_allclose(loss.information, best / ours, rtol=0.02)
    assert max(loss.information) < 0.9
    read_off = np.diag(by_beam)[1:3]
    assert loss.variance_over_beam == pytest.approx(ours.sum() / read_off.sum(), rel=0.04)


def test_signal_to_noise_is_that_of_matched_filters() -> None:
    observation = _observation()
    tapered = weighted(observation, (GaussianTaper(6 * ARCSEC),))
    loss = weighting_loss(tapered.map_baselines(), ALPHA, Exponential())
    (natural,), (seen,) = observation.chunks(), tapered.chunks()
    w, q = natural.weights[:, 0], seen.weights[:, 0]
    u, v = natural.uvw[:, :2].T * FREQUENCY / SPEED_OF_LIGHT
    noise = np.random.default_rng(4).normal(size=(4000, len(w))) / np.sqrt(w)
    for model, found in (
        (np.ones(len(w)), loss.snr_point),
        (_model(u, v, 1.0, 0j, ALPHA), loss.snr_galaxy),
    ):
        scatter = [np.std(noise @ (f * model)) / np.sum(f * model**2) for f in (w, q)]
        assert found == pytest.approx(scatter[0] / scatter[1], rel=0.04)
    assert loss.snr_point < 0.8


def test_baselines_of_one_length_tell_no_shape() -> None:
    (seen,) = _observation().chunks()
    length = np.hypot(seen.uvw[:, 0], seen.uvw[:, 1])
    same = seen.uvw * (5e3 / length)[:, None]
    ring = VisibilitySet(PhaseCentre(0.0, 0.0), (replace(seen, uvw=same),))
    with pytest.raises(
        InputError, match="do not determine the shape of a galaxy of scale length 1"
    ):
        weighting_loss(weighted(ring, ()).map_baselines(), ALPHA, Exponential())


def test_natural_weights_lose_nothing() -> None:
    cells = weighted(_observation(), ()).map_baselines()
    loss = weighting_loss(cells, ALPHA, Exponential())
    assert loss.snr_point == pytest.approx(1, abs=1e-12)
    assert loss.snr_galaxy == pytest.approx(1, abs=1e-12)
    assert loss.information == pytest.approx((1, 1), abs=1e-9)
    assert loss.variance_over_beam == pytest.approx(1, abs=1e-9)


def test_a_round_psf_is_round_40_deg_from_zenith_under_any_weight() -> None:
    """SKA-Mid AA4, 8 h, at the declination that culminates 40 degrees from its zenith."""
    track = Track.from_clock(PhaseCentre(0.3, math.radians(9.3)), ((-14400.0, 14400.0),), 3600.0)
    uvw = synthesise(load_layout("ska-mid-aa4"), track).uvw
    ones = np.ones((len(uvw), 1), np.float32)
    block = Visibilities(uvw, FREQUENCY, ones.astype(np.complex64), ones)
    natural = VisibilitySet(track.phase_centre, (block,))
    rounded = weighted(natural, (RoundPsf(),))
    grid = ImageGrid(300, 0.1 * ARCSEC)
    for observation, is_round in ((natural, False), (rounded, True)):
        image = point_spread_function(observation, grid, executor=in_threads(2))
        found = [measure_psf(image, grid.pixel, sigma * ARCSEC).ellipticity for sigma in (1.0, 3.0)]
        found.append(fit_main_lobe(image, grid.pixel).ellipticity)
        if is_round:
            assert max(map(abs, found)) < 0.005
        else:
            assert min(map(abs, found)) > 0.05
    cells = rounded.map_baselines()
    loss = weighting_loss(cells, ARCSEC, Exponential())
    assert min(loss.information) > 0.85
    assert loss.snr_galaxy > 0.97
