"""The residual of an observation: its visibilities less those of a sky that changes by a few sources at a time."""

import math
from collections.abc import Iterator
from dataclasses import dataclass, fields
from typing import Final

import numpy as np

from uvshear.execution import Resources
from uvshear.galaxy import Galaxies, Profile
from uvshear.geometry.directions import PhaseCentre
from uvshear.interferometer.screening import screened_chunks
from uvshear.interferometer.visibilities import Observation, Visibilities
from uvshear.predict.direct import predict_multiples
from uvshear.typing import Array, Bool, Complex

HELD_PART: Final = 1 / 8
"""Part of the memory of a measurement that the visibilities of the sky may take."""

BITS: Final = 44
"""Visibilities are rounded to 2^-44 of the flux of all sources, so that the sums of up to 2^9 times this flux are exact
(``predict_multiples``)."""


class SubtractedSky:
    """Visibilities of the sources of a sky, which are subtracted from those of an observation.

    They are held in memory as far as they fit. When some sources have changed, only these are computed again. Sums over
    sources are exact, so that neither the memory nor the order of the changes has an effect on the residual.

    Parameters
    ----------
    first
        The sky, with fluxes that show the order of magnitude.
    profile
        Brightness profile of all sources.
    resources
        Executor of the sums over sources, and memory of the measurement.
    """

    def __init__(self, first: Galaxies, profile: Profile, resources: Resources) -> None:
        total = float(np.sum(np.abs(first.flux)))
        self._unit = 2.0 ** (math.ceil(math.log2(total)) - BITS) if total > 0 else 1.0
        self._profile, self._executor = profile, resources.executor
        self._free = HELD_PART * resources.memory
        self._held: dict[int, _HeldModel] = {}

    def residual(self, number: int, seen: Visibilities, sky: Galaxies) -> Visibilities:
        """Subtract a sky from the chunk of this number."""
        held = self._held.get(number)
        if held is None:
            held = _HeldModel(sky, self._sum(sky, seen))
            if held.model.nbytes <= self._free:
                self._free -= held.model.nbytes
                self._held[number] = held
        elif np.any(changed := _changed(held.sky, sky)):
            held.model += self._sum(sky.select(changed), seen)
            held.model -= self._sum(held.sky.select(changed), seen)
            held.sky = sky
        return seen.with_stokes_i(seen.stokes_i - self._unit * held.model)

    def _sum(self, sky: Galaxies, seen: Visibilities) -> Complex[Array, "row chan"]:
        return predict_multiples(
            sky, seen.uvw, seen.frequency, self._profile, self._unit, self._executor
        )


@dataclass
class _HeldModel:
    """A sky and its visibilities at the samples of a chunk, in units."""

    sky: Galaxies
    model: Complex[Array, "row chan"]


@dataclass(frozen=True)
class Residual:
    """An observation less a sky.

    Parameters
    ----------
    observation
        The observation, whose chunks are the same in every pass.
    sky
        All sources.
    subtracted
        Visibilities of earlier skies with these sources.
    """

    observation: Observation
    sky: Galaxies
    subtracted: SubtractedSky

    @property
    def phase_centre(self) -> PhaseCentre:
        """Direction of l = m = 0."""
        return self.observation.phase_centre

    def chunks(self) -> Iterator[Visibilities]:
        """Yield the chunks less the sky, without the samples that cannot be right."""
        for number, seen in enumerate(screened_chunks(self.observation)):
            yield self.subtracted.residual(number, seen, self.sky)


def _changed(before: Galaxies, now: Galaxies) -> Bool[Array, " source"]:
    """Mask the sources of which any parameter has changed."""
    columns = [each.name for each in fields(now) if each.name != "reference_frequency"]
    return np.any([getattr(before, name) != getattr(now, name) for name in columns], axis=0)
