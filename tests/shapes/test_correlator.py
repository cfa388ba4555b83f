"""Sums over cells against numpy, in both precisions."""

from dataclasses import replace

import numpy as np
import pytest

from tests.shapes.facets import ALPHA, EXPONENTIAL, GAUSSIAN, noisy
from uvshear.shapes.correlator import CHUNK, Correlator

PROFILES = {"exponential": EXPONENTIAL, "gaussian": GAUSSIAN}
ENVELOPES = {"exponential": lambda q: (1 + q) ** -1.5, "gaussian": lambda q: np.exp(-q / 2)}

TOLERANCES = [
    # dtype, error of <d, m> over its own deviation sqrt<m, m> at SNR 100, relative error of <m, m>
    (np.float32, 1e-4, 1e-6),  # measured 5e-5, 3e-7: ln L = h^2/2N to 5e-3
    (np.float64, 1e-10, 1e-13),  # measured 4e-13, 2e-15
]


def _envelope(kind, uv, e, log_alpha):
    inverse = np.linalg.inv([[1 - e.real, -e.imag], [-e.imag, 1 + e.real]])
    k = 2 * np.pi * np.exp(log_alpha) * inverse.T @ uv.T
    return ENVELOPES[kind](np.sum(k**2, axis=0))


def _facet(number=600):
    return noisy(np.random.default_rng(3), 0.2 - 0.1j, snr=100.0, number=number)[0]


@pytest.mark.parametrize("number", [37, 600, CHUNK + 300])
@pytest.mark.parametrize("kind", PROFILES)
@pytest.mark.parametrize(("dtype", "of_data", "of_norm"), TOLERANCES)
def test_correlations_are_the_sums_over_cells(dtype, of_data, of_norm, kind, number):
    facet = _facet(number)
    rng = np.random.default_rng(1)
    e = 0.6 * rng.uniform(size=100) * np.exp(1j * rng.uniform(0, 6, 100))
    log_alpha = np.log(ALPHA) + rng.normal(0, 0.3, 100)
    centre, nodes = np.array([0.3, -0.2]) * ALPHA, rng.normal(0, 0.3, (3, 2)) * ALPHA
    correlator = Correlator(facet, PROFILES[kind], dtype)
    correlator.move_to(centre / correlator.length)
    displaced = correlator.displaced_to(nodes / correlator.length)
    heights, norms = correlator.correlate(e, log_alpha, displaced)
    phase = np.exp(2j * np.pi * facet.uv @ (centre + nodes).T)
    for t in range(0, 100, 9):
        model = _envelope(kind, facet.uv, e[t], log_alpha[t])
        norm = np.sum(facet.power * model**2)
        expected = np.real(facet.correlation.conj() @ (model[:, None] * phase))
        got = heights[t] / correlator.flux_unit
        # the sign of the displacement, a conjugate: tens
        assert np.abs(got - expected).max() < of_data * np.sqrt(norm)
        assert norms[t] / correlator.flux_unit**2 == pytest.approx(norm, rel=of_norm)


@pytest.mark.parametrize("kind", PROFILES)
@pytest.mark.parametrize(("dtype", "allowed"), [(np.float32, 2e-5), (np.float64, 1e-7)])
def test_normal_sums_are_those_of_the_models_derivatives(dtype, allowed, kind):
    facet, e, log_alpha, step = _facet(), 0.3 - 0.4j, float(np.log(ALPHA)) + 0.1, 1e-5
    correlator = Correlator(facet, PROFILES[kind], dtype)
    derivatives = correlator.form_derivatives(e, log_alpha)
    sums = correlator.normal_sums(correlator.form(e, log_alpha), derivatives)

    def model(d=0j, a=0.0):
        return _envelope(kind, facet.uv, e + d, log_alpha + a)

    responses = np.array(
        [
            model(),
            (model(step) - model(-step)) / (2 * step),
            (model(1j * step) - model(-1j * step)) / (2 * step),
            (model(0, step) - model(0, -step)) / (2 * step),
        ]
    )
    power, data = facet.power / facet.power.sum(), facet.correlation / np.sqrt(facet.power.sum())
    xy = 2 * np.pi * correlator.length * facet.uv.T
    gram = (responses * power) @ responses.T
    pairs = (
        (sums.products, responses @ data.real),
        (sums.gram, gram),
        (sums.position_gradient, xy @ (data.imag * model())),
        (sums.position_curvature, (xy * power * model() ** 2) @ xy.T),
    )
    largest = max(np.abs(expected).max() for _, expected in pairs)
    for got, expected in pairs:
        np.testing.assert_allclose(got, expected, rtol=0, atol=allowed * largest)
    assert sums.norm == sums.gram[0, 0]


def test_units_cancel_in_what_comes_out():
    facet = _facet()
    scaled = replace(facet, correlation=facet.correlation * 1e9, power=facet.power * 1e18)
    first, second = (Correlator(f, EXPONENTIAL) for f in (facet, scaled))
    shape = np.array([0.2j]), np.array([np.log(ALPHA)])
    a, b = (c.correlate(*shape, c.displaced_to(np.zeros((1, 2)))) for c in (first, second))
    np.testing.assert_allclose(a[0], b[0], rtol=1e-5)
    assert first.flux_unit == pytest.approx(second.flux_unit * 1e9)
    assert first.length == second.length
