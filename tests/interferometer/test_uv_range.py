"""Ranges of baselines."""

from uvshear.interferometer.uv_range import UvRange


def test_a_range_without_ends_is_everything():
    assert UvRange().is_everything
    assert not UvRange(minimum=10.0).is_everything
    assert not UvRange(maximum=1e9).is_everything
