"""Samples: columns of numbers, one row a source."""

import numpy as np

from uvshear.estimators.sample import Sample, ellipticity_of


def _sample():
    e = 0.1 * np.arange(5)
    return Sample({"e1": e, "e2": -2 * e}, np.linspace(0, 1, 5))


def test_selected_sources_keep_their_numbers_and_their_north():
    sample = _sample()
    for chosen in (np.array([1, 3]), np.arange(5) % 2 == 1, slice(1, 5, 2)):
        part = sample.select(chosen)
        assert len(part) == 2
        np.testing.assert_array_equal(part["e1"], sample["e1"][[1, 3]])
        np.testing.assert_array_equal(part.local_north, [0.25, 0.75])


def test_the_ellipticity_is_complex():
    np.testing.assert_allclose(ellipticity_of(_sample()), 0.1 * np.arange(5) * (1 - 2j))


def test_rows_become_columns_of_numbers_and_of_objects():
    rows = [
        {"flux": 1.0, "n": 2, "array": np.zeros(3), "object": {"any": 1}},
        {"flux": np.float32(2.0), "n": np.int64(3), "array": np.zeros(3), "object": None},
    ]
    sample = Sample.from_rows(rows)
    assert sample["flux"].dtype == sample["n"].dtype == float
    np.testing.assert_array_equal(sample["n"], [2, 3])
    # arrays of one length are no table
    assert sample["array"].shape == (2,)
    assert sample["array"][1].shape == (3,)
    assert sample["object"].tolist() == [{"any": 1}, None]
    np.testing.assert_array_equal(sample.local_north, [0, 0])


def test_no_rows_are_an_empty_sample():
    assert len(Sample.from_rows([])) == 0
