"""The weighted mean of ellipticities."""

import numpy as np
import pytest

from uvshear.errors import InputError
from uvshear.estimators.estimate import estimate_sample_shear
from uvshear.estimators.mean import Mean
from uvshear.estimators.sample import Sample


def _galaxies(number=4000, g=0.03 - 0.02j, seed=3):
    """Ellipticities of the (l, m) frame behind a shear of the frame of the sky."""
    rng = np.random.default_rng(seed)
    sigma = rng.uniform(0.05, 0.4, number)
    noise = rng.normal(size=(2, number)) * np.sqrt(0.06 + sigma**2)
    return np.conj(g + noise[0] + 1j * noise[1]), 1 / (0.06 + sigma**2)


def _shear(e, weight):
    e, weight = np.asarray(e), np.asarray(weight, float)
    sample = Sample({"e1": e.real, "e2": e.imag, "weight": weight}, np.zeros(len(e)))
    return estimate_sample_shear(Mean(), sample)


def test_the_shear_is_the_weighted_mean():
    e, weight = _galaxies(50)
    shear = _shear(e, weight)
    expected = np.average(e, weights=weight)
    assert (shear.g1, shear.g2) == pytest.approx((expected.real, -expected.imag), rel=1e-12)
    assert shear.n == 50


def test_a_known_mean_is_recovered_within_its_error():
    shear = _shear(*_galaxies())
    for value, error, true in ((shear.g1, shear.g1_err, 0.03), (shear.g2, shear.g2_err, -0.02)):
        assert error < 0.006  # 0.30/sqrt(4000) = 0.0048
        assert abs(value - true) < 3 * error  # measured 0.5 and 0.2


def test_the_error_is_that_of_the_weighted_mean():
    e, weight = _galaxies()
    shear = _shear(e, weight)
    # weights are inverse variances: the mean's is 1/sum w
    analytic = 1 / np.sqrt(weight.sum())
    assert shear.g1_err == pytest.approx(analytic, rel=0.04)
    assert shear.g2_err == pytest.approx(analytic, rel=0.04)


def test_what_was_not_measured_is_left_out():
    e, weight = _galaxies(100)
    bad_e = np.concatenate([e, [np.nan, complex(0, np.nan), 0.9, 0.9]])
    bad_weight = np.concatenate([weight, [1e3, 1e3, 0.0, np.nan]])
    assert _shear(bad_e, bad_weight) == _shear(e, weight)


def test_the_scale_of_the_weights_does_not_matter():
    e, weight = _galaxies(100)
    first, second = (_shear(e, w) for w in (weight, 1e6 * weight))
    assert second.g1 == pytest.approx(first.g1, rel=1e-12)
    assert second.g1_err == pytest.approx(first.g1_err, rel=1e-10)


def test_the_order_of_the_galaxies_does_not_matter():
    e, weight = _galaxies(1090)
    order = np.random.default_rng(4).permutation(1090)
    expected, shuffled = _shear(e, weight), _shear(e[order], weight[order])
    for name in ("g1", "g1_err", "g2", "g2_err"):
        assert getattr(shuffled, name) == pytest.approx(getattr(expected, name), rel=1e-10)


@pytest.mark.parametrize("weight", [[1.0], [0.0, 0.0, 0.0], [1.0, np.nan, 0.0]])
def test_fewer_than_two_galaxies_are_an_error(weight):
    with pytest.raises(InputError, match="fewer than 2 contribute to the shear"):
        _shear(np.full(len(weight), 0.1 + 0j), weight)


def test_the_noise_bias_is_told():
    assert "moments" in Mean.remark
    assert "bayesian" in Mean.remark
