"""A shear as it was estimated."""

import json

from uvshear.estimators.shear_estimate import ShearEstimate

BIN = ShearEstimate(0.03, 0.02, 0.0, 0.02, 30, "moments")
FOUND = ShearEstimate(
    0.02, 0.01, -0.01, 0.012, 100, "moments", bins={"10-20 uJy": BIN}, assumed={"seed": 1}
)


def test_numbers_are_for_a_file_and_name_the_frame():
    assert json.loads(json.dumps(FOUND.numbers())) == {
        "g1": 0.02,
        "g1_err": 0.01,
        "g2": -0.01,
        "g2_err": 0.012,
        "n": 100,
        "estimator": "moments",
        "frame": "sky",
    }


def test_it_reads_as_a_line():
    line = "g1 = +0.02000 +- 0.01000, g2 = -0.01000 +- 0.01200 (moments, 100 galaxies)"
    assert str(FOUND) == line


def test_the_shear_is_complex():
    assert FOUND.shear == 0.02 - 0.01j
