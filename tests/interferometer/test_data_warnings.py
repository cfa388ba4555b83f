"""Warnings about data, as functions of what a pass has gathered."""

from uvshear.interferometer.data_warnings import DataQuality, data_warnings
from uvshear.interferometer.sample_counts import SampleCounts


def test_good_data_call_for_no_warning():
    counts = SampleCounts(rows=10, samples=40, usable=30, flagged=10)
    assert data_warnings(DataQuality("a.ms", counts=counts)) == ()
    assert data_warnings(DataQuality("a.ms")) == ()


def test_samples_left_out_without_a_flag_are_counted():
    counts = SampleCounts(samples=6720, non_finite=8, non_positive_weights=4)
    infinite, weightless = data_warnings(DataQuality("a.ms", counts=counts))
    assert infinite.startswith("a.ms: 8 of 6720 visibilities are NaN or infinite")
    assert weightless.startswith("a.ms: 4 of 6720 visibilities have a weight of zero or less")
    assert all(
        line.endswith("without being flagged; they are left out") for line in (infinite, weightless)
    )


def test_autocorrelations_with_a_baseline_are_told():
    counts = SampleCounts(rows=10, autocorrelations=7, autocorrelations_with_uvw=3)
    (told,) = data_warnings(DataQuality("a.ms", counts=counts))
    assert told == (
        "a.ms: the number of rows with two equal antennas but a UVW that is not zero is 3; they are left out as"
        " autocorrelations"
    )


def test_notices_carry_the_name_of_the_data():
    assert data_warnings(DataQuality("a.ms", ("it is odd",))) == ("a.ms: it is odd",)
