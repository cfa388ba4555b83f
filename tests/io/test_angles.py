"""Angles that are written out."""

import numpy as np
import pytest
from astropy.coordinates import Angle
from hypothesis import given
from hypothesis import strategies as st

from uvshear.io.angles import degrees_of, is_sexagesimal


@given(st.floats(-89.99, 89.99), st.sampled_from([":", " ", "dms", "fromunit"]))
def test_declinations_are_astropys(degrees, separator):
    text = Angle(degrees, "deg").to_string(sep=separator, precision=8, pad=True, alwayssign=True)
    assert degrees_of([text], in_hours=False)[0] == pytest.approx(degrees, abs=1e-11)


@given(st.floats(0, 359.99), st.sampled_from([":", " ", "hms"]))
def test_right_ascensions_are_astropys(degrees, separator):
    text = Angle(degrees, "deg").to_string(unit="hourangle", sep=separator, precision=9)
    assert degrees_of([text], in_hours=True)[0] == pytest.approx(degrees, abs=1e-10)


@pytest.mark.parametrize(
    ("text", "in_hours", "degrees"),
    [
        ("-00:30:00", False, -0.5),
        ("\u221227:35:15", False, -(27 + 35 / 60 + 15 / 3600)),
        ("12 30", False, 12.5),
        ("03:28.5", True, 15 * (3 + 28.5 / 60)),
        ("3h28m12.6s", False, 15 * (3 + 28 / 60 + 12.6 / 3600)),
        ("60d30m", True, 60.5),
        ("60°30′36″", True, 60.51),
        ("23:59:60.0", True, 360.0),
        ("52.5", True, 52.5),
    ],
)
def test_the_usual_spellings_are_read(text, in_hours, degrees):
    assert degrees_of([text], in_hours=in_hours)[0] == pytest.approx(degrees, abs=1e-12)


@pytest.mark.parametrize(
    "text", ["", "here", "12:60:00", "12:30:61", "12:30:15:7", "12:30.5:15", "h12"]
)
def test_what_is_no_angle_is_nan(text):
    assert np.isnan(degrees_of([text], in_hours=False)[0])


def test_plain_numbers_are_not_sexagesimal():
    assert is_sexagesimal("12:30:15")
    assert not is_sexagesimal("12.5")
    assert not is_sexagesimal("1e-3")
