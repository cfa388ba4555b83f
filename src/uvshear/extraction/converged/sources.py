"""A source of the sky model: its prior, its fit, and its model on the cells of a facet."""

from abc import ABC, abstractmethod
from dataclasses import dataclass, replace
from typing import Self

import numpy as np

from uvshear.galaxy import Profile
from uvshear.interferometer.facet import Facet
from uvshear.shapes.measurement import GalaxyFit
from uvshear.shapes.point import fit_point
from uvshear.shapes.prior import ShapePrior
from uvshear.shapes.shape import fit_galaxy
from uvshear.shapes.template import Template, moved
from uvshear.typing import Array, Complex, Float

RELEASE = 100.0
"""Factor by which a sky model's prior on e is widened where the prior must not matter."""


@dataclass(frozen=True)
class ModelledSource(ABC):
    """A source that is subtracted.

    Parameters
    ----------
    prior
        Prior of its shape, flux and position in the sky model.
    profile
        Brightness profile of the galaxies of the field.
    expected
        The source as it is assumed to be where nothing better is known; its flux is that of the catalogue.
    """

    prior: ShapePrior
    profile: Profile
    expected: GalaxyFit

    @abstractmethod
    def fit(self, facet: Facet, start: GalaxyFit | None) -> GalaxyFit | None:
        """Find the most likely source; None where none was found."""

    def model(self, fit: GalaxyFit, uv: Float[Array, "cell 2"]) -> Complex[Array, " cell"]:
        """Predict the fitted source on the cells of its facet [Jy]."""
        return Template(uv, self.profile).model(fit)

    def released(self) -> Self:
        """Return the source with a very wide prior on its ellipticity."""
        loose = self.prior.ellipticity_sigma * RELEASE
        return replace(self, prior=replace(self.prior, ellipticity_sigma=loose))

    def after_step(self, fit: GalaxyFit, step: Float[Array, " 6"]) -> GalaxyFit:
        """Return the source after a step in its parameters, shortened to a credible length."""
        if fit.flux <= 0:
            return fit
        longest = np.array([0.5 * fit.flux, 0.3, 0.3, 0.4, *[self.prior.position_sigma / 2] * 2])
        shortened = step * min(1.0, float(np.min(longest / np.maximum(np.abs(step), 1e-300))))
        new = moved(fit, shortened)
        return replace(new, snr=fit.snr * new.flux / fit.flux)

    def refit(self, facet: Facet, starts: tuple[GalaxyFit | None, ...]) -> GalaxyFit:
        """Return the best of the fits from several starts, where None starts from scratch.

        If there is none, the expected source is returned at its best flux.
        """
        fits = [fit for start in starts if (fit := self.fit(facet, start)) is not None]
        if fits:
            return max(fits, key=lambda fit: self._log_posterior(fit, facet))
        h, norm = self._correlation(self.expected, facet)
        flux = max(h / norm, 0.0) * self.expected.flux if norm > 0 else 0.0
        fallback = self.expected
        return GalaxyFit(flux, fallback.offset, fallback.ellipticity, fallback.scale_length, 0.0)

    def _correlation(self, fit: GalaxyFit, facet: Facet) -> tuple[float, float]:
        model = self.model(fit, facet.uv)
        h = float(np.sum((facet.correlation * model.conj()).real))
        return h, float(np.sum(facet.power * np.abs(model) ** 2))

    def _log_posterior(self, fit: GalaxyFit, facet: Facet) -> float:
        h, norm = self._correlation(fit, facet)
        return h - norm / 2 - 0.5 * self.prior.penalty(fit)


@dataclass(frozen=True)
class GalaxySource(ModelledSource):
    """A galaxy: flux, position, size and ellipticity are fitted."""

    def fit(self, facet: Facet, start: GalaxyFit | None) -> GalaxyFit | None:
        """Find the most likely galaxy."""
        return fit_galaxy(facet, self.prior, self.profile, start)


@dataclass(frozen=True)
class PointSource(ModelledSource):
    """A star or an active nucleus: flux and position are fitted."""

    def fit(self, facet: Facet, start: GalaxyFit | None) -> GalaxyFit | None:
        """Find the most likely point source."""
        return fit_point(facet, self.prior, start)
