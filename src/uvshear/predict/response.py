r"""Response of the samples to sources: spectra, smearing and primary beams.

The factor of a source in the samples is a smooth function of its position and of its spectral index. The factors of all
sources of a tile are linear combinations of those of a few sources, which are the columns that a pivoted QR
decomposition of the factors at some samples chooses. A single image of a tile for all samples cannot represent such
factors; a few images can.
"""

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Self, TypeAlias

import numpy as np
from scipy.linalg import qr, solve_triangular

from uvshear.galaxy import Galaxies
from uvshear.interferometer.attenuation import Attenuation
from uvshear.interferometer.samples import Samples
from uvshear.typing import Array, Float, Int

TOLERANCE = 1e-4
"""Error of a factor that is a combination of others, over the strongest factor."""

FILTER_TOLERANCE = 3e-3
"""Relative error of a matched filter that is a combination of others, as an rms over the noise-weighted samples. The
information on a source and the steps of the extraction are wrong by about this fraction, and its result is not."""

FAINTEST = 1e-2
"""Smallest fraction of its flux that attenuation must leave of a source that is modelled."""

_MOST_ROWS = 192
"""Number of random combinations of samples that take the place of the samples where there are more of them: the factors
are combinations of some tens, so that these few tell them apart as well as thousands of samples."""

_FEWEST = 64
"""Number of samples in a band below which the samples of all bands are used to choose the sources."""

_OUTERMOST = 8
"""Number of outermost sources that are used to decide whether there is any attenuation."""


SeenAs: TypeAlias = tuple[float, float, float]
"""What the factor of a source depends on: its direction cosines l and m, and its spectral index."""


def seen_as(galaxies: Galaxies, source: int) -> SeenAs:
    """Return what the factor of a source depends on."""
    return (
        float(galaxies.l[source]),
        float(galaxies.m[source]),
        float(galaxies.spectral_index[source]),
    )


@dataclass(frozen=True)
class SharedFactors:
    """Factors of all sources in terms of a few: factor_s = sum over j of coefficients_js factor_chosen_j."""

    chosen: Int[Array, " term"]
    coefficients: Float[Array, "term source"]

    @classmethod
    def from_factors(
        cls, factors: Float[Array, "probe source"], tolerance: float = TOLERANCE
    ) -> Self:
        """Choose as few sources as the tolerance allows."""
        _, upper, order = qr(_compressed(factors), mode="economic", pivoting=True)
        diagonal = np.abs(np.diag(upper))
        rank = max(int(np.sum(diagonal > tolerance * diagonal[0])), 1)
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
        if self.is_common(galaxies):
            return np.ones(len(galaxies))
        return self._rms(self.factors(self._need_probes(), galaxies))

    def attenuations(self, galaxies: Galaxies) -> Float[Array, " source"]:
        """Fraction of each source's flux that averaging and primary beams leave, as an rms over the probes."""
        if self.attenuation is None:
            return np.ones(len(galaxies))
        return self.strengths(galaxies) / replace(self, attenuation=None).strengths(galaxies)

    def matched_filter(
        self, samples: Samples, l: float, m: float, index: float
    ) -> Float[Array, " sample"] | float:
        """Filter that matches a source, besides the common power law: its own factor with a root mean square of 1.

        Parameters
        ----------
        samples
            Samples at which the filter is evaluated.
        l, m
            Direction cosines of the source.
        index
            Spectral index of the source.
        """
        if self.attenuation is None and index == self.index:
            return 1.0
        at_probes = self.source_factor(self._need_probes(), l, m, index)
        rms = float(self._rms((at_probes * np.ones(len(self._weight)))[:, None])[0])
        return np.asarray(self.source_factor(samples, l, m, index) / rms, np.float32)

    def shared_filters(
        self, galaxies: Galaxies, shortest: float, longest: float, power: int = 1
    ) -> SharedFactors:
        """Express the filters of sources by a few, on baselines within a range [wavelengths].

        The filters are those of :meth:`matched_filter`, raised to a power: a beam has their squares.
        """
        if self.is_common(galaxies):
            return _all_alike(len(galaxies))
        chosen = self._within(shortest, longest)
        factors = self.factors(self._need_probes(), galaxies)
        filters = factors[chosen] / self._rms(factors)
        weight = self._weight[chosen]
        weighted = filters**power * np.sqrt(weight / weight.sum())[:, None]
        return SharedFactors.from_factors(weighted, FILTER_TOLERANCE)

    def shared_factors(self, galaxies: Galaxies, shortest: float, longest: float) -> SharedFactors:
        """Own factors of sources in terms of a few, on baselines within a range [wavelengths]."""
        if self.is_common(galaxies):
            return _all_alike(len(galaxies))
        seen = self._need_probes().select(self._within(shortest, longest))
        return SharedFactors.from_factors(self.factors(seen, galaxies))

    def _within(self, shortest: float, longest: float) -> Int[Array, " probe"]:
        """Probes on baselines within a range, or all of them where these are too few."""
        distance = self._need_probes().uv_distance
        chosen = np.flatnonzero((distance >= shortest) & (distance < longest))
        return chosen if len(chosen) >= _FEWEST else np.arange(len(distance))

    def is_common(self, galaxies: Galaxies) -> bool:
        """Whether the factors of all sources are 1."""
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

    def factors(self, samples: Samples, galaxies: Galaxies) -> Float[Array, "sample source"]:
        """Evaluate the own factor of every source at some samples."""
        factors = [
            self.source_factor(samples, *seen_as(galaxies, source)) * np.ones(len(samples))
            for source in range(len(galaxies))
        ]
        return np.stack(factors, axis=-1).astype(float)


def _all_alike(sources: int) -> SharedFactors:
    return SharedFactors(np.zeros(1, int), np.ones((1, sources)))


def _compressed(factors: Float[Array, "probe source"]) -> Float[Array, "row source"]:
    """Combine samples at random where there are more than are needed to tell sources apart."""
    if min(factors.shape) <= _MOST_ROWS:
        return factors
    combination = np.random.default_rng(1).standard_normal((_MOST_ROWS, len(factors)))
    return combination @ factors / np.sqrt(_MOST_ROWS)
