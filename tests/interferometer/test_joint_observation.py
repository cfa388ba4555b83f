"""Several observations read as one."""

import math

import pytest

from tests.interferometer.chunks import CENTRE, chunk, observation
from uvshear.constants import ARCSEC
from uvshear.errors import InputError
from uvshear.geometry.directions import PhaseCentre
from uvshear.interferometer.joint_observation import JointObservation
from uvshear.interferometer.visibilities import Observation, VisibilitySet


def _at(dec, ra=CENTRE.ra):
    return VisibilitySet(PhaseCentre(ra, dec), (chunk(1),))


def test_parts_are_read_one_after_the_other():
    joint = JointObservation.from_parts([observation(1, 2), observation(3)])
    assert isinstance(joint, Observation)
    assert joint.phase_centre == CENTRE
    frequencies = [block.frequency[0] for block in joint.chunks()]
    assert frequencies == [1.01e9, 1.02e9, 1.03e9]


def test_phase_centres_differ_by_rounding_only():
    JointObservation.from_parts([_at(CENTRE.dec), _at(CENTRE.dec + 1e-4 * ARCSEC)])
    JointObservation.from_parts([_at(0.1), _at(0.1, CENTRE.ra + 2 * math.pi)])
    with pytest.raises(InputError, match="its phase centre is 1 arcsec from that of"):
        JointObservation.from_parts([_at(CENTRE.dec), _at(CENTRE.dec + ARCSEC)])
