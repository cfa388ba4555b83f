r"""Response of the samples to sources: spectra, smearing and primary beams.

The factor of a source in the samples is a smooth function of its position and of its spectral index. The factors of all
sources of a tile are linear combinations of those of a few sources, which are the columns that a pivoted QR
decomposition of the factors at some samples chooses. A single image of a tile for all samples cannot represent such
factors; a few images can.
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
"""Error of a factor that is a combination of others, over the strongest factor."""

FAINTEST = 1e-2
"""Smallest fraction of its flux that attenuation must leave of a source that is modelled."""

_FEWEST = 64
"""Number of samples in a band below which the samples of all bands are used to choose the sources."""

_OUTERMOST = 8
"""Number of outermost sources that are used to decide whether there is any attenuation."""


@dataclass(frozen=True)
class SharedFactors:
    """Factors of all sources in terms of a few: factor_s = sum over j of coefficients_js factor_chosen_j."""

    chosen: Int[Array, " term"]
    coefficients: Float[Array, "term source"]

    @classmethod
    def from_factors(cls, factors: Float[Array, "probe source"]) -> Self:
        """Choose as few sources as the tolerance allows."""
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

    The first factor, the gain, is common to all sources; the others differ from source to source.

    Parameters
    ----------
    index
        beta_0, the median spectral index.
    reference_frequency
        nu_ref [Hz].
    attenuation
        a; None if there is none.
    probes
        Samples with weights, spread over all samples that are used; they are needed where sources differ.
    """

    index: float
    reference_frequency: float
    attenuation: Attenuation | None = None
    probes: Samples | None = None

    @classmethod
    def from_sky(
        cls,
        galaxies: Galaxies,
        probes: Samples | None = None,
        attenuation: Attenuation | None = None,
    ) -> Self:
        """Response to the galaxies of a sky; an attenuation that has no effect on any of them is left out."""
        index = float(np.median(galaxies.spectral_index)) if len(galaxies) else 0.0
        if attenuation is not None and probes is not None:
            distance = np.hypot(galaxies.l, galaxies.m)
            outermost = galaxies.select(np.argsort(distance)[-_OUTERMOST:])
            remaining = (
                attenuation.factor(probes, *place).min()
                for place in zip(outermost.l.tolist(), outermost.m.tolist(), strict=True)
            )
            if min(remaining, default=1.0) > 1 - 1e-5:
                attenuation = None
        return cls(index, galaxies.reference_frequency, attenuation, probes)

    def gain(self, frequency: Float[Array, " sample"]) -> Float[Array, " sample"]:
        """Evaluate the common power law at each frequency [Hz]."""
        return ((frequency / self.reference_frequency) ** self.index).astype(np.float32)

    def source_factor(
        self, samples: Samples, l: float, m: float, index: float
    ) -> Float[Array, " sample"] | float:
        """Evaluate a source's own factor; 1 where it has none.

        Parameters
        ----------
        samples
            Samples at which the factor is evaluated.
        l, m
            Direction cosines of the source.
        index
            Spectral index of the source.
        """
        factor: Float[Array, " sample"] | float = 1.0
        if index != self.index:
            ratio = samples.frequency / self.reference_frequency
            factor = (ratio ** (index - self.index)).astype(np.float32)
        if self.attenuation is not None:
            factor = factor * self.attenuation.factor(samples, l, m).astype(np.float32)
        return factor

    def strengths(self, galaxies: Galaxies) -> Float[Array, " source"]:
        """Root mean square of each source's own factor over the weighted probes; the flux of a facet includes it."""
        if self._is_common(galaxies):
            return np.ones(len(galaxies))
        return self._rms(self._factors(self._need_probes(), galaxies))

    def attenuations(self, galaxies: Galaxies) -> Float[Array, " source"]:
        """Fraction of each source's flux that averaging and primary beams leave, as an rms over the probes."""
        if self.attenuation is None:
            return np.ones(len(galaxies))
        return self.strengths(galaxies) / replace(self, attenuation=None).strengths(galaxies)

    def matched_filter(
        self, samples: Samples, l: float, m: float
    ) -> Float[Array, " sample"] | float:
        """Filter that matches sources in a direction, besides the common power law; its root mean square is 1."""
        if self.attenuation is None:
            return 1.0
        remaining = float(self._rms(self.attenuation.factor(self._need_probes(), l, m)[:, None])[0])
        if remaining < FAINTEST:
            # Attenuation leaves next to nothing in this direction, and no source is modelled there.
            return 1.0
        return (self.attenuation.factor(samples, l, m) / remaining).astype(np.float32)

    def shared_factors(self, galaxies: Galaxies, shortest: float, longest: float) -> SharedFactors:
        """Own factors of sources in terms of a few, on baselines within a range [wavelengths]."""
        if self._is_common(galaxies):
            return SharedFactors(np.zeros(1, int), np.ones((1, len(galaxies))))
        probes = self._need_probes()
        distance = probes.uv_distance
        chosen = np.flatnonzero((distance >= shortest) & (distance < longest))
        seen = probes.select(chosen) if len(chosen) >= _FEWEST else probes
        return SharedFactors.from_factors(self._factors(seen, galaxies))

    def _is_common(self, galaxies: Galaxies) -> bool:
        return self.attenuation is None and bool(np.all(galaxies.spectral_index == self.index))

    def _rms(self, factors: Float[Array, "probe source"]) -> Float[Array, " source"]:
        """Root mean square of factors at the probes, weighted by the information of these on a source."""
        return np.sqrt(self._weight @ factors**2)

    @cached_property
    def _weight(self) -> Float[Array, " probe"]:
        probes = self._need_probes()
        weight = probes.weights * self.gain(probes.frequency).astype(float) ** 2
        return weight / weight.sum()

    def _need_probes(self) -> Samples:
        assert self.probes is not None, "sources with different responses need probes"
        return self.probes

    def _factors(self, samples: Samples, galaxies: Galaxies) -> Float[Array, "sample source"]:
        sources = zip(
            galaxies.l.tolist(),
            galaxies.m.tolist(),
            galaxies.spectral_index.tolist(),
            strict=True,
        )
        factors = [
            self.source_factor(samples, *source) * np.ones(len(samples)) for source in sources
        ]
        return np.stack(factors, axis=-1).astype(float)
