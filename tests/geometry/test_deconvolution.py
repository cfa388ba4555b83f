"""Widths of sources without the beam."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from uvshear.geometry.deconvolution import FittedGaussians, deconvolved_widths, matrix_of

BEAM = (4.0, 3.0, 0.6)


def _fitted(source, errors=(0.0, 0.0, 0.0), beam=BEAM):
    """Gaussian of a source (axes and angle) convolved with a beam, by the eigenvectors of the sum of matrices."""
    both = np.array([source, beam], float).T
    values, vectors = np.linalg.eigh(matrix_of(*both).sum(axis=0))
    axes = np.sqrt(values[::-1])
    angle = np.arctan2(vectors[1, 1], vectors[0, 1])
    return FittedGaussians(*(np.array([value]) for value in (*axes, angle, *errors)))


def _beam(beam=BEAM):
    return matrix_of(*(np.array([value]) for value in beam))


@given(st.floats(1.0, 9.0), st.floats(0.6, 1.0), st.floats(0.0, 3.1))
def test_the_width_is_the_geometric_mean_of_the_axes_of_the_source(long, ratio, angle):
    width, err, is_resolved = deconvolved_widths(_fitted((long, ratio * long, angle)), _beam())
    assert is_resolved[0]
    assert err[0] == 0
    assert width[0] == pytest.approx(long * np.sqrt(ratio), rel=1e-9)


def test_the_short_axis_counts_as_half_of_the_long_one_or_more():
    width, _, _ = deconvolved_widths(_fitted((4.0, 0.1, 0.3)), _beam())
    assert width[0] == pytest.approx(np.sqrt(4.0 * 2.0))


@pytest.mark.parametrize("source", [(6.0, 4.0, 1.1), (8.0, 5.0, 0.2), (5.0, 0.5, 2.0)])
@pytest.mark.parametrize("errors", [(0.08, 0.06, 0.03), (0.002, 0.002, 0.04)])
def test_the_error_of_the_width_is_the_scatter_under_errors_of_the_fit(source, errors):
    """20000 draws: their standard deviation is known to 0.5 per cent, and the error is of first order."""
    fitted = _fitted(source, errors)
    rng = np.random.default_rng(5)
    drawn = [
        np.full(20000, mean[0]) + err * rng.standard_normal(20000)
        for mean, err in zip((fitted.major, fitted.minor, fitted.angle), errors, strict=True)
    ]
    zero = np.zeros(20000)
    widths, _, _ = deconvolved_widths(
        FittedGaussians(*drawn, zero, zero, zero), np.repeat(_beam(), 20000, axis=0)
    )
    _, err, _ = deconvolved_widths(fitted, _beam())
    # The second errors are almost those of the angle alone, without which nothing would be left.
    assert err[0] == pytest.approx(widths.std(), rel=0.03)


def test_what_is_less_than_two_errors_above_the_beam_has_a_limit():
    """A fit as large as the beam, with an error s of the squared long axis, is smaller than sqrt(2 s)."""
    fitted = _fitted((0.0, 0.0, 0.0), (0.2, 0.1, 0.05))
    width, err, is_resolved = deconvolved_widths(fitted, _beam())
    assert not is_resolved[0]
    assert err[0] == 0
    # The eigenvectors of a difference of zero are any; each axis has an error of its own.
    assert 2 * (2 * 3 * 0.1) * 0.9 < width[0] ** 2 < 2 * (2 * 4 * 0.2) * 1.1


def test_a_fit_below_the_beam_is_no_failure():
    fitted = FittedGaussians(*(np.array([value]) for value in (3.8, 2.9, 0.6, 0.1, 0.1, 0.1)))
    width, _, is_resolved = deconvolved_widths(fitted, _beam())
    assert not is_resolved[0]
    assert 0 < width[0] < 2


def test_without_errors_the_limit_is_the_beam():
    fitted = FittedGaussians(*(np.array([value]) for value in (*BEAM, 0.0, 0.0, 0.0)))
    width, _, is_resolved = deconvolved_widths(fitted, _beam())
    assert not is_resolved[0]
    assert width[0] == pytest.approx(np.sqrt(12.0))
