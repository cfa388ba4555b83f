"""The number of samples that is known before a pass."""

from tests.interferometer.chunks import CENTRE, observation
from uvshear.interferometer.expected_samples import expected_samples
from uvshear.interferometer.held_observation import HeldObservation
from uvshear.interferometer.joint_observation import JointObservation


class Unknown:
    """An observation that does not know how many samples it has."""

    phase_centre = CENTRE

    def chunks(self):
        yield from ()


def test_the_samples_of_all_parts_are_expected():
    some, more = observation(1), observation(1, 2)
    counts = [sum(each.stokes_i.size for each in part.chunks()) for part in (some, more)]
    assert expected_samples(HeldObservation(some, 0.0)) == counts[0]
    assert expected_samples(JointObservation(CENTRE, (some, more))) == sum(counts)


def test_an_observation_of_which_a_part_is_unknown_has_no_number():
    assert expected_samples(Unknown()) == 0
    assert expected_samples(JointObservation(CENTRE, (observation(1), Unknown()))) == 0
