"""What all tests of the bias take: one beam, which takes seconds to gather, and estimators that keep their weights."""

import pytest

from tests.bias.surveys import SHEARS, plan
from uvshear.bias.isolated import Experiment
from uvshear.bias.survey import Survey
from uvshear.estimators.moments import Moments
from uvshear.galaxy import PowerLawFlux
from uvshear.simulation.population import Population


@pytest.fixture(scope="session")
def beam():
    return Survey(plan()).isolated(SHEARS).beam


@pytest.fixture(scope="session")
def experiment(beam):
    return Experiment(beam, SHEARS, seed=3)


@pytest.fixture(scope="session")
def bright(beam):
    population = Population(flux=PowerLawFlux(minimum=50e-6, maximum=200e-6))
    return Experiment(beam, SHEARS, population=population, seed=3)


@pytest.fixture(scope="session")
def moments():
    """One for all tests: it keeps its weights."""
    return Moments()
