"""The ways to make facets of simulated galaxies: those of the paper, and exact ones."""

import math
from abc import ABC, abstractmethod
from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np

from uvshear.bias.cell_average import CellAverageBeam, CellCount
from uvshear.bias.mock_facets import FacetBeam, MockBeam
from uvshear.constants import SPEED_OF_LIGHT
from uvshear.galaxy import Galaxies
from uvshear.interferometer.visibilities import Visibilities, VisibilitySet
from uvshear.reproduce.ring_mean_beam import RingMeanBeam
from uvshear.reproduce.weighted_beam import WeightedBeam
from uvshear.typing import Array, Float


@dataclass(frozen=True)
class WeighedSamples:
    """The samples of a pointing at one frequency, with natural weights and the factors of a weighting.

    Parameters
    ----------
    block
        Samples with natural weights [Jy^-2].
    seen
        The observation that consists of them.
    factors
        Factors T of the weighting.
    scale
        Number by which the weights are multiplied, so that the errors of a galaxy of median size are right.
    """

    block: Visibilities
    seen: VisibilitySet
    factors: Float[Array, "row 1"]
    scale: float

    @property
    def uv(self) -> Float[Array, "row 2"]:
        """Baselines [wavelengths]."""
        uv: Float[Array, "row 2"] = self.block.uvw[:, :2] * (
            float(self.block.frequency[0]) / SPEED_OF_LIGHT
        )
        return uv

    @property
    def natural(self) -> Float[Array, " row"]:
        """Natural weights [Jy^-2]."""
        return np.asarray(self.block.weights[:, 0], float)

    def with_weights(self, weights: Float[Array, "row 1"]) -> VisibilitySet:
        """Return the observation with other weights."""
        return replace(self.seen, blocks=(replace(self.block, weights=weights),))


class FacetWay(ABC):
    """A way to make facets.

    Attributes
    ----------
    seconds
        Processor time of drawing a facet and measuring the shape of its galaxy, about [s].
    """

    seconds: ClassVar[float]

    @abstractmethod
    def beam(self, samples: WeighedSamples, smallest: float) -> FacetBeam:
        """Return the beam from which facets are drawn.

        Parameters
        ----------
        samples
            Samples of the pointing.
        smallest
            Scale length of the smallest galaxies [rad].
        """


@dataclass(frozen=True)
class CellFacets(FacetWay):
    """Averages in cells, as in the paper.

    Parameters
    ----------
    rule
        Rule for the number of cells.
    longest
        Part of the longest baseline up to which samples are used; the cells extend to there.
    """

    seconds = 0.035

    rule: CellCount
    longest: float = 1.0

    def beam(self, samples: WeighedSamples, smallest: float) -> CellAverageBeam:
        """Sort the samples by the length of their baselines."""
        del smallest
        uv, natural = samples.uv, samples.natural
        factors = np.asarray(samples.factors[:, 0], float)
        length = np.hypot(*uv.T)
        used = length <= self.longest * length.max()
        return CellAverageBeam.from_samples(
            uv[used], natural[used], factors[used], samples.scale, self.rule
        )


@dataclass(frozen=True)
class ExactFacetWay(FacetWay):
    """Exact facets, as in the rest of this package."""

    seconds = 0.012

    def beam(self, samples: WeighedSamples, smallest: float) -> FacetBeam:
        """Image the beam of the weights, and that of the noise unless the weights are natural."""
        natural, factors = samples.block.weights, samples.factors * samples.scale
        nobody = _nobody(smallest)
        signal = MockBeam.gather(samples.with_weights(natural * factors), nobody, smallest)
        if np.all(factors == 1):
            return signal
        noise = MockBeam.gather(samples.with_weights(natural * factors**2), nobody, smallest)
        return WeightedBeam(signal, noise)


@dataclass(frozen=True)
class RoundNoise(ExactFacetWay):
    """Exact facets with noise whose variance is that of the weights: an experiment, which no data can give."""

    def beam(self, samples: WeighedSamples, smallest: float) -> FacetBeam:
        """Image the beam of the weights."""
        weights = samples.block.weights * samples.factors * samples.scale
        return MockBeam.gather(samples.with_weights(weights), _nobody(smallest), smallest)


@dataclass(frozen=True)
class RoundCoverage(ExactFacetWay):
    """Exact facets with a round coverage of the uv plane, so that PSF and noise are round: an experiment."""

    def beam(self, samples: WeighedSamples, smallest: float) -> FacetBeam:
        """Replace the power of the beam by its means over rings."""
        return RingMeanBeam(super().beam(samples, smallest))


def _nobody(scale_length: float) -> Galaxies:
    """Return a galaxy without flux, which has the same flux at all frequencies."""
    return Galaxies(
        l=np.zeros(1),
        m=np.zeros(1),
        flux=np.zeros(1),
        scale_length=np.array([scale_length]),
        ellipticity=np.zeros(1, complex),
        spectral_index=np.zeros(1),
    )


def smallest_scale_length(log_median: float, sigma: float) -> float:
    """Return the scale length two standard deviations below the median [rad]."""
    return math.exp(log_median - 2 * sigma)
