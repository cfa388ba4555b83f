"""A bias as it was simulated."""

import json

import numpy as np

from uvshear.estimators.bias import Bias


def test_a_record_is_for_a_file_and_a_line_for_the_terminal():
    values = [np.array(pair) for pair in ((0.01, -0.02), (0.1, 0.2), (1e-3, 0.0), (1e-4, 2e-4))]
    bias = Bias("all", *values, np.array([3.0, 4.0]), 50, failed=2)
    record = json.loads(json.dumps(bias.record()))
    assert record["m2"] == -0.02
    assert record["c2_err"] == 2e-4
    assert (record["response2"], record["n"], record["failed"]) == (4.0, 50, 2)
    assert str(bias) == (
        "all: m1 = +0.01000 +- 0.10000, m2 = -0.02000 +- 0.20000, c1 = +0.00100 +- 0.00010,"
        " c2 = +0.00000 +- 0.00020 (50 galaxies, 2 measurements failed)"
    )


def test_numbers_that_are_not_known_are_left_out():
    """Without a shear there is no m; a file of version 0.1.0 has no response."""
    nothing, some = np.full(2, np.nan), np.array([1e-3, 2e-3])
    bias = Bias("all", nothing, nothing, some, some / 10, nothing, 50)
    assert set(bias.record()) == {"c1", "c1_err", "c2", "c2_err", "n", "failed"}


def test_bins_are_found_by_their_names():
    values = [np.zeros(2)] * 5
    bins = tuple(Bias(name, *values, 10) for name in ("10-20 uJy", "20-50 uJy"))
    assert dict(Bias("all", *values, 20, bins=bins).by_flux) == dict(
        zip(("10-20 uJy", "20-50 uJy"), bins, strict=True)
    )
