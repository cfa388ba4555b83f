"""Origins and parts of observations that are made of others."""

from dataclasses import replace

from tests.interferometer.chunks import CENTRE, observation
from uvshear.interferometer.joint_observation import JointObservation
from uvshear.interferometer.origin import HasOrigin, HasParts, Origin, origin_of, parts_of
from uvshear.interferometer.scaled_observation import ScaledObservation
from uvshear.interferometer.weighting import WeightedObservation

FIRST, SECOND = observation(1), observation(2)
JOINT = JointObservation(CENTRE, (FIRST, SECOND))


def test_an_observation_in_memory_is_its_own_only_part_and_origin():
    assert parts_of(FIRST) == (FIRST,)
    assert origin_of(FIRST) == Origin(FIRST)
    assert not isinstance(FIRST, HasParts | HasOrigin)


def test_the_origin_of_changed_weights_is_what_was_changed():
    for changed in (
        ScaledObservation(FIRST, 2.0),
        WeightedObservation(FIRST),
        WeightedObservation(ScaledObservation(FIRST, 2.0)),
    ):
        assert origin_of(changed) == Origin(FIRST, weights_tell_noise=False)
        assert parts_of(changed) == (changed,)


def test_parts_keep_what_was_done_to_the_whole():
    assert parts_of(JOINT) == (FIRST, SECOND)
    scaled = ScaledObservation(JOINT, 2.0)
    assert parts_of(scaled) == (ScaledObservation(FIRST, 2.0), ScaledObservation(SECOND, 2.0))
    weighted = WeightedObservation(scaled, scale=3.0)
    parts = parts_of(weighted)
    assert parts[1] == replace(weighted, natural=ScaledObservation(SECOND, 2.0))
    whole = [chunk.weights for chunk in weighted.chunks()]
    divided = [chunk.weights for part in parts for chunk in part.chunks()]
    assert all((one == other).all() for one, other in zip(whole, divided, strict=True))
