"""Frames of positions."""

import numpy as np
import pytest
from astropy.io import fits

from uvshear.errors import InputError
from uvshear.io.frames import EquatorialFrame, frame_of_metadata

ICRS = EquatorialFrame()
B1950 = EquatorialFrame("FK4", 1950.0)


@pytest.mark.parametrize(
    ("metadata", "expected"),
    [
        ({}, ICRS),
        ({"equinox": 2000.0}, EquatorialFrame("FK5", 2000.0)),
        ({"equinox": "J2000"}, EquatorialFrame("FK5", 2000.0)),
        ({"equinox": "2000.0"}, EquatorialFrame("FK5", 2000.0)),
        ({"equinox": 1950}, B1950),
        ({"equinox": "B1950"}, B1950),
        ({"equinox": "1950.0"}, B1950),
        ({"equinox": "J1950"}, EquatorialFrame("FK5", 1950.0)),
        ({"equinox": 2010.0}, EquatorialFrame("FK5", 2010.0)),
        ({"radesys": "ICRS", "equinox": 2000.0}, ICRS),
        ({"radesys": "FK5"}, EquatorialFrame("FK5", 2000.0)),
        ({"radecsys": "FK4"}, B1950),
        ({"radecsys": "FK4-NO-E", "equinox": 1950.0}, EquatorialFrame("FK4-NO-E", 1950.0)),
        ({"radesys": "FK5", "equinox": 1975.0}, EquatorialFrame("FK5", 1975.0)),
        ({"coordsys": "eq_FK4", "equinox": "B1975"}, EquatorialFrame("FK4", 1975.0)),
        ({"coordsys": "J2000"}, EquatorialFrame("FK5", 2000.0)),
        ({"equinox": None}, ICRS),
        ({"equinox": "None", "radesys": ""}, ICRS),
        ({"equinox": np.nan}, ICRS),
        ({"equinox": fits.card.Undefined()}, ICRS),
    ],
)
def test_metadata_state_the_frame(metadata, expected):
    assert frame_of_metadata(metadata) == expected


@pytest.mark.parametrize(
    ("metadata", "message"),
    [
        ({"radesys": "GALACTIC"}, "its positions are in the system 'GALACTIC'; ICRS, FK5 or FK4"),
        ({"coordsys": "ecl_FK5"}, "its positions are in the system 'ecl_FK5'"),
        ({"radesys": "GAPPT"}, "in the system 'GAPPT'"),
        ({"equinox": "soon"}, "its equinox is 'soon'; a year such as J2000"),
        ({"equinox": 0.0}, "its equinox is '0.0'"),
    ],
)
def test_other_frames_are_refused(metadata, message):
    with pytest.raises(InputError, match=message):
        frame_of_metadata(metadata)


@pytest.mark.parametrize("frame", [ICRS, EquatorialFrame("FK5", 2000.0)])
def test_j2000_is_taken_as_it_is(frame):
    ra, dec = np.array([0.3]), np.array([-0.5])
    assert frame.to_icrs(ra, dec) == (ra, dec)


PLACES = np.radians([[187.0, 2.0], [60.0, -30.0], [10.0, 80.0], [300.0, -75.0], [0.0, 0.0]])
ARCSEC = np.radians(1 / 3600)


def _apart(first, second):
    """Distance on the sky [arcsec]."""
    unit = [
        np.stack([np.cos(d) * np.cos(r), np.cos(d) * np.sin(r), np.sin(d)])
        for r, d in (first, second)
    ]
    return np.linalg.norm(unit[0] - unit[1], axis=0) / ARCSEC


def test_b1950_is_precessed_as_by_casacore():
    measures = pytest.importorskip("casacore.measures").measures()
    ra, dec = PLACES.T
    found = B1950.to_icrs(ra, dec)
    expected = []
    for place in PLACES:
        there = measures.direction("B1950", f"{place[0]}rad", f"{place[1]}rad")
        expected.append([measures.measure(there, "J2000")[m]["value"] for m in ("m0", "m1")])
    # casacore assumes that the places were measured in 2000, and astropy in 1950. FK4 rotates by 0.5 arcsec a century:
    # they differ by 0.25 arcsec, and by 0.026 with the same assumption. Another equinox is minutes of arc away.
    assert np.max(_apart(found, np.array(expected).T)) < 0.3


def test_3c_273_is_where_it_is():
    """B1950 12 26 33.246 +02 19 43.47 is J2000 12 29 06.70 +02 03 08.6 (NED): measured 0.10 arcsec."""
    hours, degrees = np.radians(15 / 3600), np.radians(1 / 3600)
    there = (
        np.array([(12 * 60 + 26) * 60 + 33.246]) * hours,
        np.array([2 * 3600 + 19 * 60 + 43.47]) * degrees,
    )
    here = (
        np.array([(12 * 60 + 29) * 60 + 6.70]) * hours,
        np.array([2 * 3600 + 3 * 60 + 8.6]) * degrees,
    )
    assert _apart(B1950.to_icrs(*there), here)[0] < 0.2


def test_another_equinox_is_precessed_by_the_general_precession():
    """A year is 50.29 arcsec along the ecliptic; at the equinox 46.1 in right ascension and 20.04 in declination."""
    zero = np.zeros(1)
    ra, dec = EquatorialFrame("FK5", 2010.0).to_icrs(zero, zero)
    assert (ra[0] - 2 * np.pi) / ARCSEC == pytest.approx(-461.2, abs=0.5)
    assert dec[0] / ARCSEC == pytest.approx(-200.4, abs=0.5)
