"""The sky of two galaxies that touch, after a major cycle, as tests of the minor cycle take it."""

from dataclasses import dataclass, replace

import numpy as np

from tests.extraction.converged.major_cycles import GRIDDING
from tests.extraction.fields import OPTIONS, field_of, pair
from uvshear.execution import SERIAL
from uvshear.extraction import MeasurementOptions
from uvshear.extraction.converged.baselines import Baselines
from uvshear.extraction.converged.major_cycle import first_major_cycle
from uvshear.extraction.converged.modelled_field import ModelledField
from uvshear.extraction.converged.planner import Planner
from uvshear.extraction.converged.sky_state import SkyState
from uvshear.galaxy import Galaxies
from uvshear.interferometer.visibilities import Observation
from uvshear.io.catalogue import Catalogue


@dataclass(frozen=True)
class Prepared:
    """A sky after its first major cycle, and what led to it."""

    observation: Observation
    planner: Planner
    state: SkyState
    truth: Galaxies

    @property
    def modelled(self) -> ModelledField:
        return self.planner.modelled

    def ellipticities(self, state: SkyState) -> np.ndarray:
        return np.array([fit.ellipticity for fit in state.fits])


def prepare(
    observation: Observation,
    catalogue: Catalogue,
    truth: Galaxies,
    options: MeasurementOptions = OPTIONS,
) -> Prepared:
    """Run the first major cycle, with all baselines."""
    field = field_of(observation, catalogue, options)
    modelled = ModelledField.from_field(field, options.model, observation.phase_centre.dec)
    planner = Planner(modelled, Baselines.from_field(field, modelled.is_galaxy, 0.0), 45.0)
    fits = modelled.expected
    plan, sky = planner.plan(fits), planner.subtracted(fits)
    cycle = first_major_cycle(observation, plan, planner.plan_beams(), sky, GRIDDING)
    state = SkyState.from_major_cycle(cycle, modelled.sources, fits, SERIAL)
    return Prepared(observation, planner, state, truth)


def touching_pair(snr_factor: float = 1.0) -> Prepared:
    """Prepare two galaxies without noise, weighed as if they had an SNR of some hundreds times a factor."""
    observation, catalogue, truth = pair()
    (block,) = observation.blocks
    weighed = replace(block, weights=block.weights * snr_factor**2)
    return prepare(replace(observation, blocks=(weighed,)), catalogue, truth)


def nothing() -> None:
    """Hear of a fit."""
