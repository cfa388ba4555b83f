"""Checks of the data against a sky: the sign of UVW, the unit of fluxes, outliers, and the noise.

The noise may correct the weights. The checks work on the few thousand visibilities of each part that the first pass has
drawn, so that each costs one prediction of these visibilities and no further reading.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Final

import numpy as np

from uvshear.diagnostics.flux_scale import flux_scale
from uvshear.diagnostics.uvw_sign import opposite_sign_significance
from uvshear.execution import Executor
from uvshear.extraction import Model
from uvshear.galaxy import Galaxies
from uvshear.interferometer.joint_observation import JointObservation
from uvshear.interferometer.noise_estimate import CLEAR, NoiseEstimate, estimate_noise
from uvshear.interferometer.noise_sample import NoiseSample
from uvshear.interferometer.noise_warning import noise_warning
from uvshear.interferometer.origin import origin_of, parts_of
from uvshear.interferometer.outliers import outlier_warning, weight_warning
from uvshear.interferometer.samples import Samples
from uvshear.interferometer.scaled_observation import ScaledObservation
from uvshear.interferometer.uv_range import UvRange
from uvshear.interferometer.visibilities import Observation
from uvshear.predict.at_samples import predict_at_samples
from uvshear.predict.response import Response
from uvshear.typing import Array, Complex

MOST_SOURCES: Final = 64
"""Number of sources, the brightest of a catalogue, by which the sign of UVW and the unit of fluxes are judged."""

MOST_PRODUCTS: Final = 2**19
"""Largest number of sources times visibilities of a part that are predicted: 50 ms of one core with attenuation, and
three times this with neighbours."""

FEWEST: Final = 2**12
"""Number of visibilities of a part that are predicted however many sources there are: the noise is then known to 1.1
per cent."""

UNCHANGED: Final = 0.02
"""Fraction by which the noise of a scaled observation may be off without being corrected."""


@dataclass(frozen=True)
class DataChecks:
    """Comparison of an observation with skies.

    Parameters
    ----------
    observation
        The observation.
    samples
        Visibilities that were drawn from each part of it; None for a part without weight.
    model
        Assumptions about the sources.
    is_attenuated
        Whether averaging and primary beams attenuate the sources.
    executor
        Executor of the predictions.
    """

    observation: Observation
    samples: Sequence[NoiseSample | None]
    model: Model
    is_attenuated: bool
    executor: Executor

    @property
    def takes_noise_from_data(self) -> bool:
        """Whether the weights of any part are to be scaled to the noise of its data."""
        return any(isinstance(part, ScaledObservation) for part in parts_of(self.observation))

    def sign_warnings(self, sky: Galaxies) -> tuple[str, ...]:
        """Return one line for each part whose visibilities agree with the sky under the opposite sign of UVW."""
        found = []
        for name, seen, model in self._compared(_brightest(sky)):
            by = opposite_sign_significance(seen, model)
            if by is not None:
                found.append(
                    f"{name}: the visibilities agree with the catalogue if UVW is taken with the"
                    f" opposite sign ({by:.0f} standard errors); with the present sign, sources appear rotated by 180"
                    " degrees about the phase centre; to reverse the sign, give --conjugate, or leave it out if it is"
                    " given (in Python, change Reading.conjugates)"
                )
        return tuple(found)

    def flux_warnings(self, sky: Galaxies) -> tuple[str, ...]:
        """Return one line for each part whose visibilities are out of proportion to the catalogue's fluxes.

        The sources are taken as points: where sizes follow from the fluxes, these would be wrong, too.
        """
        points = replace(sky, scale_length=np.zeros(len(sky)))
        found = []
        for name, seen, model in self._compared(_brightest(points)):
            scale = flux_scale(seen, model)
            if scale is not None:
                found.append(
                    f"{name}: the visibilities are about {scale:.0e} times those that the catalogue"
                    " predicts; check the unit of the catalogue's fluxes"
                )
        return tuple(found)

    def weight_warnings(self) -> tuple[str, ...]:
        """Return one line for each part in which the weights of a few visibilities exceed those of all others."""
        lines = (
            weight_warning(origin_of(part).name, sample.here.weights)
            for part, sample in zip(parts_of(self.observation), self.samples, strict=True)
            if sample is not None and origin_of(part).weights_tell_noise
        )
        return tuple(line for line in lines if line is not None)

    def noise_warnings(self, sky: Galaxies, uv_range: UvRange) -> tuple[str, ...]:
        """Return one line for each part whose weights do not agree with its noise, judging by the residual of a sky.

        Where they agree, a line may report a few visibilities that differ from the sky by more than noise can explain.
        Weights that were scaled to the noise of the data or changed by another weighting are not compared.

        Parameters
        ----------
        uv_range
            Baselines on which the sky was fitted.
        """
        sources = _with_flux(sky)
        lines = []
        for part, sample, noise in zip(
            parts_of(self.observation), self.samples, self.noise(sky, uv_range), strict=True
        ):
            name = origin_of(part).name
            if sample is None or not origin_of(part).weights_tell_noise:
                continue
            within = _affordable(sample.within(uv_range), sources).here
            lines.append(
                noise_warning(name, noise)
                or outlier_warning(name, within, partial(self._predict, sources))
            )
        return tuple(line for line in lines if line is not None)

    def noise(self, sky: Galaxies, uv_range: UvRange) -> tuple[NoiseEstimate | None, ...]:
        """Estimate the ratio of each part's noise to the noise that its weights imply, from the residual of a sky."""
        sources = _with_flux(sky)
        found: list[NoiseEstimate | None] = []
        for part, sample in zip(parts_of(self.observation), self.samples, strict=True):
            claimed = 1 / part.noise if isinstance(part, ScaledObservation) else 1.0
            if sample is None:
                found.append(None)
                continue
            within = _affordable(sample.within(uv_range), sources)
            found.append(estimate_noise(within, partial(self._predict, sources), claimed))
        return tuple(found)

    def with_noise_of_data(self, sky: Galaxies, uv_range: UvRange) -> Observation | None:
        """Return the observation with its scaled parts corrected to their noise; None where nothing is to be corrected.

        The residual of the sky shows how far the earlier estimate of the noise is off.
        """
        parts = parts_of(self.observation)
        corrected = tuple(
            _corrected(part, noise)
            for part, noise in zip(parts, self.noise(sky, uv_range), strict=True)
        )
        if all(new is old for new, old in zip(corrected, parts, strict=True)):
            return None
        if len(corrected) == 1:
            return corrected[0]
        return JointObservation(self.observation.phase_centre, corrected)

    def _compared(
        self, sources: Galaxies
    ) -> Iterator[tuple[str, Samples, Complex[Array, " sample"]]]:
        """Yield the name of each part with weight, some of its visibilities, and their prediction [Jy]."""
        if not len(sources):
            return
        for part, sample in zip(parts_of(self.observation), self.samples, strict=True):
            if sample is not None:
                seen = _affordable(sample, sources).here
                yield origin_of(part).name, seen, self._predict(sources, seen)

    def _predict(self, sources: Galaxies, samples: Samples) -> Complex[Array, " sample"]:
        attenuation = None
        if self.is_attenuated:
            attenuation = self.model.attenuation(self.observation.phase_centre.dec)
            # Where attenuation has no effect, it would cost ten times as much as the rest.
            attenuation = Response.from_sky(sources, samples, attenuation).attenuation
        profile = self.model.profile
        return predict_at_samples(sources, samples, profile, attenuation, self.executor)


def _with_flux(sky: Galaxies) -> Galaxies:
    return sky.select(np.flatnonzero(sky.flux != 0))


def _brightest(sky: Galaxies) -> Galaxies:
    sources = _with_flux(sky)
    return sources.select(np.argsort(-sources.flux)[:MOST_SOURCES])


def _affordable(sample: NoiseSample, sources: Galaxies) -> NoiseSample:
    return sample.at_most(max(MOST_PRODUCTS // max(len(sources), 1), FEWEST))


def _corrected(part: Observation, noise: NoiseEstimate | None) -> Observation:
    if not isinstance(part, ScaledObservation) or noise is None or noise.ratio == 0:
        return part
    off = abs(noise.ratio - 1)
    if off <= max(UNCHANGED, CLEAR * noise.smallest.error):
        return part
    return part.corrected(noise.ratio)
