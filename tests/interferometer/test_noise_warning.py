"""What is said about weights that do not agree with the noise."""

import pytest

from uvshear.interferometer.noise_estimate import NoiseEstimate, Scatter
from uvshear.interferometer.noise_warning import noise_warning


def estimate(ratio, *, is_certain=True, other=None, error=0.005):
    contradicting = None if other is None else Scatter(other, 0.01, "the tail")
    return NoiseEstimate(Scatter(ratio, error, "the residual"), is_certain, contradicting)


@pytest.mark.parametrize("ratio", [0.96, 1.0, 1.04])
@pytest.mark.parametrize("is_certain", [True, False])
def test_nothing_is_said_about_right_weights(ratio, is_certain):
    assert noise_warning("a.ms", estimate(ratio, is_certain=is_certain)) is None


def test_nothing_is_said_where_nothing_is_known():
    assert noise_warning("a.ms", None) is None
    assert noise_warning("a.ms", estimate(3.0, is_certain=False)) is None
    assert noise_warning("a.ms", estimate(1.15, error=0.05)) is None


# Weights that are 20 per cent off: sqrt(0.8) and sqrt(1.2).
@pytest.mark.parametrize("ratio", [1e-4, 0.8, 0.894, 1.095, 1.2, 3.0])
def test_weights_of_another_noise_are_told(ratio):
    text = noise_warning("a.ms", estimate(ratio))
    assert text.startswith(
        f"a.ms: the noise is {ratio:.3g} times what the weights claim, judging by"
    )
    assert "the residual" in text


def test_an_upper_limit_is_told_if_it_is_below_what_the_weights_claim():
    text = noise_warning("a.ms", estimate(0.5, is_certain=False))
    assert text.startswith("a.ms: the noise is at most 0.5 times what the weights claim")


def test_what_cannot_be_told_is_said_to_be_so():
    text = noise_warning("a.ms", estimate(1.5, is_certain=False, other=3.0))
    assert text.startswith("a.ms: whether the weights agree with the noise cannot be told")
    assert "at most 1.5 times" in text
    assert "3 judging by the tail" in text
