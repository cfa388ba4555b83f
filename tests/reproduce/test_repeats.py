import numpy as np
import pytest

from tests.reproduce.surveys import small_survey
from uvshear.constants import ARCSEC
from uvshear.galaxy import Galaxies
from uvshear.reproduce.repeats import AsDrawn, OppositePairs, Ring, TurnedPairs, WithoutNoise

GALAXY = Galaxies(*(np.zeros(1) for _ in range(3)), np.ones(1), np.array([0.3 + 0j]), np.zeros(1))


@pytest.mark.parametrize(
    ("repeats", "number"),
    [(AsDrawn(), 1), (WithoutNoise(), 1), (OppositePairs(), 4), (TurnedPairs(), 8), (Ring(), 10)],
)
def test_ellipticities_add_up_to_zero_where_there_are_several(repeats, number):
    found = [part.galaxies(GALAXY).ellipticity[0] for part in repeats.realisations()]
    assert len(found) == number
    assert number == 1 or abs(sum(found)) < 1e-12


def test_noise_of_a_ring_is_shuffled_and_none_is_none():
    beam = small_survey().experiment().beam
    simulator = beam.simulator(float(np.log(ARCSEC)), 0.3)
    noise = simulator.draw_noise(np.random.default_rng(2))
    members = [part.noise(simulator, noise) for part in Ring(5).realisations()]
    for k, member in enumerate(members):
        np.testing.assert_allclose(np.sort(member.real), np.sort(noise.real))
        for other in members[:k]:
            assert abs(np.corrcoef(member.real, other.real)[0, 1]) < 5 / np.sqrt(len(noise))
    (without,) = WithoutNoise().realisations()
    assert np.all(without.noise(simulator, noise) == 0)
