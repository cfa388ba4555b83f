"""The outcome of a measurement in words."""

import re

import numpy as np
import pytest
from astropy.table import Table

from uvshear.errors import InputError
from uvshear.geometry.directions import PhaseCentre
from uvshear.io.catalogue import Catalogue
from uvshear.pipeline.outcome import check_field, tally, why_none_was_measured
from uvshear.shapes.measurement import FitFlag

CENTRE = PhaseCentre(np.radians(150.0), np.radians(2.0))


def _catalogue(ra_deg, dec_deg):
    count = len(ra_deg)
    return Catalogue(
        identifier=np.arange(count),
        flux=np.full(count, 1e-4),
        spectral_index=np.full(count, -0.7),
        ra=np.radians(ra_deg),
        dec=np.radians(dec_deg),
    )


def _shapes(flags):
    return Table({"flag": flags})


def test_flags_are_counted_the_most_frequent_first():
    flags = ["ok", "duplicate", "no_peak", "no_peak", "ok"]
    assert tally(_shapes(flags)) == "2 of 5 sources measured; 2 no_peak, 1 duplicate"
    assert tally(_shapes(["ok"])) == "1 of 1 sources measured"


def test_a_catalogue_of_another_field_is_refused_with_the_distance():
    sources = _catalogue([190.0, 192.0], [2.0, 2.0])
    flags = np.array([FitFlag.OUTSIDE_FIELD] * 2)
    with pytest.raises(InputError, match="the nearest is 40 degrees from the phase centre"):
        check_field(sources, CENTRE, flags)
    check_field(sources, CENTRE, np.array([FitFlag.OUTSIDE_FIELD, FitFlag.OK]))


def test_right_ascensions_in_hours_are_recognised():
    sources = _catalogue([10.001, 9.999], [2.0, 2.01])
    flags = np.array([FitFlag.BELOW_HORIZON, FitFlag.BELOW_HORIZON])
    with pytest.raises(InputError, match="seem to be in hours"):
        check_field(sources, CENTRE, flags)


@pytest.mark.parametrize(
    ("flags", "cause"),
    [
        (["ok", "no_peak"], None),
        (["point_source", "point_source"], None),
        (["no_peak", "no_peak", "not_detected"], "the most frequent flag is no_peak"),
    ],
)
def test_the_likely_cause_is_named(flags, cause):
    found = why_none_was_measured(_shapes(flags))
    if cause is None:
        assert found is None
    else:
        assert re.search(cause, found)
