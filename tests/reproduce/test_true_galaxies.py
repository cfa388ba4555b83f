"""Galaxies drawn from the population."""

import numpy as np

from uvshear.reproduce.true_galaxies import TrueGalaxies, blocks_of_galaxies
from uvshear.simulation.population import Population


def test_parts_hold_every_galaxy_once() -> None:
    parts = blocks_of_galaxies(23, 10)
    assert parts == {"galaxies-0": (0, 10), "galaxies-10": (10, 10), "galaxies-20": (20, 3)}


def test_a_galaxy_and_its_prior_are_those_that_were_drawn() -> None:
    population = Population()
    true = TrueGalaxies.draw(population, 4000, np.random.default_rng(3))
    assert abs(true.ellipticity.mean()) < 4 * np.std(true.ellipticity) / np.sqrt(4000)
    galaxy, prior = true.galaxy(5), true.prior(5)
    assert (galaxy.flux, galaxy.ellipticity) == (true.flux[5], true.ellipticity[5])
    assert galaxy.scale_length == true.scale_length[5]
    pull = np.log(true.scale_length / np.exp(true.size.log_median)) / true.size.sigma
    assert abs(pull.mean()) < 4 / np.sqrt(4000)
    assert abs(pull.std() - 1) < 4 / np.sqrt(8000)
    assert prior.log_scale_length == true.size.log_median[5]
