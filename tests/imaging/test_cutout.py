"""Facets of squares of pixels against plain Fourier sums."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import fft

from tests.reference import plane
from uvshear.imaging.cutout import Cutout, cutout, cutout_size

PIXEL = 8e-6
NYQUIST = 0.5 / PIXEL
CUTOUTS = [Cutout(48, PIXEL, 0.0, NYQUIST / 1.2), Cutout(60, PIXEL, 0.1 * NYQUIST, 0.7 * NYQUIST)]


def _square(size, seed=1):
    return np.random.default_rng(seed).normal(size=(size, size)).astype(np.float32)


def _blob(size, pixel, offset=(0.0, 0.0)):
    """Smooth image, two cosines under a Gaussian: narrow in the sky, below half of NYQUIST in the uv plane."""
    x = (np.arange(size) - size // 2) * pixel
    l, m = np.meshgrid(x - offset[0], x - offset[1], indexing="ij")
    width = 4.0 * PIXEL
    k = 0.06 / PIXEL
    waves = np.cos(2 * np.pi * k * l + 0.3) + np.sin(2 * np.pi * 0.8 * k * m - 0.1) + 0.5
    return (waves * np.exp(-(l**2 + m**2) / 2 / width**2)).astype(np.float32)


@pytest.mark.parametrize("square_cutout", CUTOUTS)
def test_a_facet_is_the_fourier_sum_of_its_square(square_cutout):
    square = _square(square_cutout.size)
    expected = plane.facet(square, PIXEL, square_cutout.uv, square_cutout.multiplicity)
    got = square_cutout.transform(square)
    # measured 2e-7; no conjugate, or the origin in a corner: 1.4
    np.testing.assert_allclose(got, expected, rtol=0, atol=1e-6 * np.abs(expected).max())


@pytest.mark.parametrize("square_cutout", CUTOUTS)
def test_a_transform_leaves_its_square_alone(square_cutout):
    square = _square(square_cutout.size)
    before = square.copy()
    square_cutout.transform(square)
    square_cutout.add_coarse(
        square[: square_cutout.size // 2, : square_cutout.size // 2].copy(),
        1.0,
        square_cutout.transform(square),
    )
    np.testing.assert_array_equal(square, before)


def test_the_facet_of_an_image_is_sufficient_for_models_that_its_cells_resolve():
    """<d, m> = sum over x of I(x) b(x), by the sum over cells (the docstring of ``extraction.exact``)."""
    square_cutout = Cutout(48, PIXEL, 0.0, NYQUIST / 1.2)
    image, model = _square(48), _blob(48, PIXEL, (2.3 * PIXEL, -1.2 * PIXEL))
    x = (np.arange(48) - 24) * PIXEL
    u, v = square_cutout.uv.T
    along = [np.exp(2j * np.pi * k[:, None] * x) for k in (u, v)]
    of_model = np.einsum("ki,ij,kj->k", along[0], model.astype(float), along[1])
    got = float(np.sum((square_cutout.transform(image) * of_model.conj()).real))
    model[0, :] = model[:, 0] = 0
    expected = float(np.sum(image.astype(float) * model))
    # measured 1e-6; opposite cells counted once: 0.5; those at v = 0 twice, or the origin: 0.02
    assert got == pytest.approx(
        expected, abs=1e-5 * float(np.linalg.norm(image) * np.linalg.norm(model))
    )


@pytest.mark.parametrize("square_cutout", CUTOUTS)
def test_cells_are_those_of_half_the_plane_within_the_range_each_once(square_cutout):
    k = np.rint(square_cutout.uv * square_cutout.size * PIXEL).astype(int)
    cells = {tuple(cell) for cell in k.tolist()}
    assert len(cells) == len(k)
    nyquist = square_cutout.size // 2
    for i in range(-nyquist, nyquist):
        for j in range(-nyquist, nyquist):
            distance = np.hypot(i, j) / square_cutout.size / PIXEL
            count = ((i, j) in cells) + ((-i, -j) in cells) * ((i, j) != (0, 0))
            assert count == (square_cutout.shortest <= distance <= square_cutout.longest)
    np.testing.assert_array_equal(square_cutout.multiplicity, np.where(np.hypot(*k.T) == 0, 1, 2))


def test_the_origin_is_the_cell_without_length():
    square_cutout = CUTOUTS[0]
    np.testing.assert_array_equal(square_cutout.uv[square_cutout.origin], 0.0)


@pytest.mark.parametrize("square_cutout", CUTOUTS)
@pytest.mark.parametrize("factor", [1.0, -0.7])
def test_a_coarse_square_adds_what_the_fine_one_would_to_the_cells_it_resolves(
    square_cutout, factor
):
    offset = (1.7 * PIXEL, -0.6 * PIXEL)
    facet = np.full(len(square_cutout.uv), 0.3 - 0.1j, np.complex64)
    square_cutout.add_coarse(_blob(square_cutout.size // 2, 2 * PIXEL, offset), factor, facet)
    low = square_cutout.resolved_cells
    fine = square_cutout.transform(_blob(square_cutout.size, PIXEL, offset))
    expected = np.full(len(square_cutout.uv), 0.3 - 0.1j)
    expected[low] += factor * fine[low]
    # measured 1e-6; a factor of 4 or the origin wrong: 1
    np.testing.assert_allclose(facet, expected, rtol=0, atol=5e-6 * np.abs(fine).max())


@pytest.mark.parametrize("square_cutout", CUTOUTS)
def test_coarse_cells_are_all_those_below_half_the_nyquist_frequency(square_cutout):
    k = np.abs(np.rint(square_cutout.uv * square_cutout.size * PIXEL))
    resolved = np.all(k < square_cutout.size // 4, axis=1)
    np.testing.assert_array_equal(square_cutout.resolved_cells, np.flatnonzero(resolved))


@settings(deadline=None)
@given(st.floats(-1.0, 1.0), st.floats(-1.0, 1.0))
def test_recentring_moves_a_source_at_the_offset_to_the_centre(x, y):
    square_cutout = CUTOUTS[0]
    offset = (x * PIXEL, y * PIXEL)
    there = square_cutout.transform(_blob(48, PIXEL, offset))
    square_cutout.recentre(there, offset)
    expected = square_cutout.transform(_blob(48, PIXEL))
    # measured 2e-7; the sign wrong: 1
    np.testing.assert_allclose(there, expected, rtol=0, atol=2e-6 * np.abs(expected).max())


@settings(deadline=None)
@given(st.floats(1e-6, 3e-3), st.floats(1e-6, 1e-4))
def test_sizes_are_multiples_of_four_quick_to_transform_at_both_pixels(width, pixel):
    size = cutout_size(width, pixel)
    assert size % 4 == 0
    assert size >= max(32, width / pixel * (1 - 1e-12))
    assert fft.next_fast_len(size // 4, real=True) == size // 4
    assert size <= max(32, 1.3 * (width / pixel + 4))


def test_sources_of_the_same_numbers_share_a_cutout():
    assert cutout(48, PIXEL, 0.0, 1e4) is cutout(48, PIXEL, 0.0, 1e4)
