r"""How samples see sources: their spectra, and what averaging and primary beams leave; many sources by way of a few.

A source's factor over the samples is a smooth function of where it is and of its spectral index, and those of all
sources of a tile are combinations of a few of them: the columns that a pivoted QR of the factors at some samples picks.
What a tile's image cannot carry, for it is one image for all samples, is so carried by a few images.
"""

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Self

import numpy as np
from scipy.linalg import qr, solve_triangular

from uvshear.galaxy import Galaxies
from uvshear.interferometer.attenuation import Attenuation
from uvshear.interferometer.samples import Samples
from uvshear.typing import Array, Float, Int

TOLERANCE = 1e-4
"""Part of the strongest factor that the few may miss of another."""


FAINTEST = 1e-2
"""Part of its flux that a source must have left, to be modelled."""

_NEGLIGIBLE = 1e-5
_FEWEST = 64
_OUTERMOST = 8
"""Sources that are asked how much is lost at all."""


@dataclass(frozen=True)
class Shared:
    """Factors of all sources from those of the ``chosen``: factor_s = sum over j of coefficients_js factor_chosen_j."""

    chosen: Int[Array, " term"]
    coefficients: Float[Array, "term source"]

    @classmethod
    def of(cls, factors: Float[Array, "probe source"]) -> Self:
        """Choose as few as the tolerance allows."""
        _, upper, order = qr(factors, mode="economic", pivoting=True)
        diagonal = np.abs(np.diag(upper))
        rank = max(int(np.sum(diagonal > TOLERANCE * diagonal[0])), 1)
        coefficients = np.zeros((rank, factors.shape[1]))
        coefficients[:, order[:rank]] = np.eye(rank)
        coefficients[:, order[rank:]] = solve_triangular(upper[:rank, :rank], upper[:rank, rank:])
        return cls(order[:rank], coefficients)


@dataclass(frozen=True)
class Response:
    r"""Factor of each source and sample.

    .. math:: (\nu/\nu_\mathrm{ref})^{\beta_0} \times (\nu/\nu_\mathrm{ref})^{\beta_s - \beta_0}\, a_k(l_s, m_s)

    The first is common to all, the rest is a source's own.

    Parameters
    ----------
    index
        beta_0, the median.
    reference_frequency
        nu_ref [Hz].
    attenuation
        a, or none.
    probes
        Samples with weights, spread over all that take part; needed where sources differ.
    """

    index: float
    reference_frequency: float
    attenuation: Attenuation | None = None
    probes: Samples | None = None

    @classmethod
    def of(
        cls,
        galaxies: Galaxies,
        probes: Samples | None = None,
        attenuation: Attenuation | None = None,
    ) -> Self:
        """Of these galaxies; an attenuation that leaves all of them as they are is none."""
        index = float(np.median(galaxies.spectral_index)) if len(galaxies) else 0.0
        if attenuation is not None and probes is not None:
            distance = np.hypot(galaxies.l, galaxies.m)
            outermost = galaxies.select(np.argsort(distance)[-_OUTERMOST:])
            left = (
                attenuation.factor(probes, *place).min()
                for place in zip(outermost.l.tolist(), outermost.m.tolist(), strict=True)
            )
            if min(left, default=1.0) > 1 - _NEGLIGIBLE:
                attenuation = None
        return cls(index, galaxies.reference_frequency, attenuation, probes)

    def gain(self, frequency: Float[Array, " sample"]) -> Float[Array, " sample"]:
        """Evaluate the common power law at each frequency [Hz]."""
        return ((frequency / self.reference_frequency) ** self.index).astype(np.float32)

    def own(
        self, samples: Samples, l: float, m: float, index: float
    ) -> Float[Array, " sample"] | float:
        """Factor of a source's own; 1 where it has none."""
        factor: Float[Array, " sample"] | float = 1.0
        if index != self.index:
            ratio = samples.frequency / self.reference_frequency
            factor = (ratio ** (index - self.index)).astype(np.float32)
        if self.attenuation is not None:
            factor = factor * self.attenuation.factor(samples, l, m).astype(np.float32)
        return factor

    def strengths(self, galaxies: Galaxies) -> Float[Array, " source"]:
        """Own factor of each source, rms over the probes and their weights: facets have it in their flux."""
        if self._is_common(galaxies):
            return np.ones(len(galaxies))
        return self._rms(self._factors(self._need_probes(), galaxies))

    def attenuations(self, galaxies: Galaxies) -> Float[Array, " source"]:
        """Part of each source's flux that averaging and primary beams leave, rms over the probes."""
        if self.attenuation is None:
            return np.ones(len(galaxies))
        return self.strengths(galaxies) / replace(self, attenuation=None).strengths(galaxies)

    def aside(self, samples: Samples, l: float, m: float) -> Float[Array, " sample"] | float:
        """Filter that matches a direction, besides the common power law; its rms is 1, as ``strengths`` has it."""
        if self.attenuation is None:
            return 1.0
        left = float(self._rms(self.attenuation.factor(self._need_probes(), l, m)[:, None])[0])
        if left < FAINTEST:
            # Next to nothing is seen there, and nothing modelled.
            return 1.0
        return (self.attenuation.factor(samples, l, m) / left).astype(np.float32)

    def shared(self, galaxies: Galaxies, shortest: float, longest: float) -> Shared:
        """Own factors of sources in terms of a few, on baselines in this range [wavelengths]."""
        if self._is_common(galaxies):
            return Shared(np.zeros(1, int), np.ones((1, len(galaxies))))
        probes = self._need_probes()
        distance = probes.uv_distance
        chosen = np.flatnonzero((distance >= shortest) & (distance < longest))
        # Of a band with next to no samples all others are asked too.
        seen = probes.select(chosen) if len(chosen) >= _FEWEST else probes
        return Shared.of(self._factors(seen, galaxies))

    def _is_common(self, galaxies: Galaxies) -> bool:
        return self.attenuation is None and bool(np.all(galaxies.spectral_index == self.index))

    def _rms(self, factors: Float[Array, "probe source"]) -> Float[Array, " source"]:
        """Of factors at the probes, by what these tell of a source."""
        return np.sqrt(self._weight @ factors**2)

    @cached_property
    def _weight(self) -> Float[Array, " probe"]:
        probes = self._need_probes()
        weight = probes.weights * self.gain(probes.frequency).astype(float) ** 2
        return weight / weight.sum()

    def _need_probes(self) -> Samples:
        assert self.probes is not None, "sources of unlike response need probes"
        return self.probes

    def _factors(self, samples: Samples, galaxies: Galaxies) -> Float[Array, "sample source"]:
        columns = zip(
            galaxies.l.tolist(),
            galaxies.m.tolist(),
            galaxies.spectral_index.tolist(),
            strict=True,
        )
        factors = [self.own(samples, *one) * np.ones(len(samples)) for one in columns]
        return np.stack(factors, axis=-1).astype(float)
