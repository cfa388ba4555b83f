"""Counts of samples."""

from uvshear.interferometer.sample_counts import SampleCounts


def test_counts_add_up():
    total = SampleCounts(1, 2, 3, 4, 5, 6, 7) + SampleCounts(10, 20, 30, 40, 50, 60, 70)
    assert total == SampleCounts(11, 22, 33, 44, 55, 66, 77)


def test_the_flagged_fraction_is_of_the_samples():
    assert SampleCounts(samples=8, flagged=2).flagged_fraction == 0.25
    assert SampleCounts().flagged_fraction == 0.0
