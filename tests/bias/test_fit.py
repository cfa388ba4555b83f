"""From sums of terms to m and c."""

import numpy as np
import pytest

from uvshear.bias.fit import TermSums, fit_bias, shears_from_sums
from uvshear.errors import InputError

SHEARS = (0.02 + 0.01j, -0.02 - 0.01j)


def _sums(found, blocks=10, rng=None, scatter=0.0):
    """Sums of terms whose ratio is ``found`` for each shear, up to a scatter of the blocks."""
    response = np.array([[2.0, 0.3], [0.3, 1.5]])
    values = np.zeros((blocks, len(found), 6))
    for k, g in enumerate(found):
        values[:, k, :2] = response @ np.array([g.real, g.imag])
        values[:, k, 2:] = response.ravel()
    if rng is not None:
        values[..., :2] += scatter * rng.normal(size=(blocks, 1, 2))
    return values


def test_m_and_c_are_those_of_a_line():
    m, c = np.array([-0.1, 0.05]), np.array([2e-3, -1e-3])
    found = [complex((1 + m[0]) * g.real + c[0], (1 + m[1]) * g.imag + c[1]) for g in SHEARS]
    got = fit_bias(TermSums(_sums(found), 100), {}, SHEARS, (0j, 0j))
    np.testing.assert_allclose(got.m, m, atol=1e-12)
    np.testing.assert_allclose(got.c, c, atol=1e-15)
    np.testing.assert_allclose(got.m_err, 0, atol=1e-12)
    # of both shears and all blocks, for each galaxy
    np.testing.assert_allclose(got.response, [2 * 10 * 2.0 / 100, 2 * 10 * 1.5 / 100])


def test_the_ratio_counts_from_the_shear_of_the_expansion():
    about = (0.01 + 0j, -0.03j)
    values = _sums([0.002 + 0.001j, 0.01 + 0j]).sum(axis=0)
    np.testing.assert_allclose(
        shears_from_sums(values, about), [[0.012, 0.001], [0.01, -0.03]], atol=1e-15
    )


def test_the_error_of_c_is_the_scatter_of_blocks():
    """The same scatter behind both shears is in c and not in m."""
    rng = np.random.default_rng(2)
    got = fit_bias(TermSums(_sums(SHEARS, 400, rng, 0.1), 400), {}, SHEARS, (0j, 0j))
    expected = 0.1 / 20 * np.sqrt(np.sum(np.linalg.inv([[2.0, 0.3], [0.3, 1.5]]) ** 2, axis=1))
    np.testing.assert_allclose(got.c_err, expected, rtol=0.15)
    np.testing.assert_allclose(got.m, 0, atol=1e-9)
    assert np.all(got.m_err < 1e-9)


def test_a_single_shear_of_zero_has_no_m():
    got = fit_bias(TermSums(_sums([1e-3 + 0j]), 10), {}, (0j,), (0j,))
    assert np.isnan(got.m).all()
    np.testing.assert_allclose(got.c, [1e-3, 0], atol=1e-15)
    assert set(got.record()) == {
        "c1",
        "c1_err",
        "c2",
        "c2_err",
        "response1",
        "response2",
        "n",
        "failed",
    }
    assert "m1" not in str(got)


def test_a_component_without_a_shear_has_no_m():
    shears = (0.02 + 0j, -0.02 + 0j)
    got = fit_bias(TermSums(_sums(shears), 10), {}, shears, (0j, 0j))
    assert np.isfinite(got.m).tolist() == [True, False]


def test_blocks_without_a_galaxy_behind_every_shear_are_left_out():
    values = _sums(SHEARS)
    values[3, 1] = 0
    values[4] = 0
    sums = TermSums(values, 8)
    assert np.flatnonzero(~sums.is_told).tolist() == [3, 4]
    assert np.isfinite(fit_bias(sums, {}, SHEARS, (0j, 0j)).m).all()


def test_bins_of_fewer_than_two_blocks_are_left_out():
    few = _sums(SHEARS)
    few[1:] = 0
    bins = {"10-20 uJy": TermSums(few, 3), "20-50 uJy": TermSums(_sums(SHEARS), 7, 2)}
    got = fit_bias(TermSums(_sums(SHEARS), 10), bins, SHEARS, (0j, 0j))
    assert [(part.name, part.n, part.failed) for part in got.bins] == [("20-50 uJy", 7, 2)]


def test_one_block_is_no_error():
    with pytest.raises(InputError, match="all: 10 galaxies in 1 blocks"):
        fit_bias(TermSums(_sums(SHEARS, blocks=1), 10), {}, SHEARS, (0j, 0j))


def test_galaxies_that_tell_nothing_are_told():
    with pytest.raises(InputError, match="no galaxy contributes to the shear"):
        shears_from_sums(np.zeros((2, 6)), (0j, 0j))
