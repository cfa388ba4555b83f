"""Exact facets of isolated galaxies with weights other than the natural ones."""

from dataclasses import dataclass, field

import numpy as np

from uvshear.bias.mock_facets import FacetBeam, FacetNoise, FacetSimulator, MockBeam
from uvshear.galaxy import Profile
from uvshear.interferometer.facet import Facet
from uvshear.shapes.measurement import GalaxyFit
from uvshear.shapes.template import Template
from uvshear.typing import Array, Float


@dataclass(frozen=True)
class WeightedSimulator(FacetSimulator):
    """Draws exact facets whose noise does not follow from their power.

    Parameters
    ----------
    noise_power
        Variance of each component of the noise in a cell [Jy^-2].
    """

    noise_power: Float[Array, " cell"]

    def facet(self, galaxy: GalaxyFit, profile: Profile, noise: FacetNoise) -> Facet:
        """Return the facet of a galaxy with noise."""
        model = Template(self.uv, profile).model(galaxy)
        correlation = self.power * model + np.sqrt(self.noise_power) * noise
        return Facet(self.uv, correlation, self.power)


@dataclass(frozen=True)
class WeightedBeam(FacetBeam):
    """The beam of the weights w T scale, and that of the variances w (T scale)^2 of the noise.

    Parameters
    ----------
    signal, noise
        Both beams, on the same pixels.
    """

    signal: MockBeam
    noise: MockBeam
    _simulators: dict[int, WeightedSimulator] = field(default_factory=dict)

    def simulator(self, log_median: float, sigma: float) -> WeightedSimulator:
        """Return the simulator for galaxies whose ln(scale length / rad) has this mean and standard deviation."""
        signal = self.signal.simulator(log_median, sigma)
        if id(signal) not in self._simulators:
            noise = self.noise.simulator(log_median, sigma)
            self._simulators[id(signal)] = WeightedSimulator(
                signal.cutout, signal.power, noise.power
            )
        return self._simulators[id(signal)]
