"""One major cycle: all models are subtracted from the visibilities, and the facets of some sources are gathered."""

from collections.abc import Callable, Sequence
from typing import Self

import numpy as np

from uvshear.execution import SERIAL, Executor
from uvshear.extraction.paper.facets import FacetBuilder
from uvshear.galaxy import Galaxies, Profile
from uvshear.interferometer.accumulate import Accumulator
from uvshear.interferometer.facet import Facet
from uvshear.interferometer.visibilities import Visibilities
from uvshear.predict import predict_visibilities
from uvshear.typing import Array, Int


class FacetAccumulator(Accumulator[list[Facet]]):
    """Feeds the residual of every chunk to the builders of some sources of a sky.

    The memory is that of one chunk and of the facets, whatever the number of rows.

    Parameters
    ----------
    sky
        All models.
    builders
        Builders of the facets.
    members
        Source of each builder, as an index of the sky.
    profile
        Brightness profile of the models.
    executor
        Executor of the builders.
    on_chunk
        Function called with the number of rows of each chunk.
    """

    def __init__(
        self,
        sky: Galaxies,
        builders: Sequence[FacetBuilder],
        members: Int[Array, " member"],
        profile: Profile,
        executor: Executor = SERIAL,
        on_chunk: Callable[[int], None] | None = None,
    ) -> None:
        self._sky, self._profile, self._executor = sky, profile, executor
        models = [sky.select(np.array([member])) for member in members]
        self._pairs = list(zip(builders, models, strict=True))
        self._on_chunk = on_chunk

    def add(self, seen: Visibilities) -> None:
        """Subtract all models from a chunk, and pass the residual to the builders."""
        residual = subtract_sky(seen, self._sky, self._profile, self._executor)

        def feed(pair: tuple[FacetBuilder, Galaxies]) -> None:
            builder, model = pair
            builder.add(residual, model)

        for _ in self._executor.map(feed, self._pairs):
            pass
        if self._on_chunk is not None:
            self._on_chunk(len(seen))

    def merge(self, later: Self) -> None:
        """Add the facets of later visibilities."""
        for (builder, _), (other, _) in zip(self._pairs, later._pairs, strict=True):
            builder.merge(other)

    def result(self) -> list[Facet]:
        """Return the facets, each with the source's own model added back."""
        return [builder.facet(model) for builder, model in self._pairs]


def subtract_sky(
    chunk: Visibilities, sky: Galaxies, profile: Profile, executor: Executor = SERIAL
) -> Visibilities:
    """Return the visibilities less those of all models."""
    model = predict_visibilities(sky, chunk.uvw, chunk.frequency, profile, executor)
    return chunk.with_stokes_i(chunk.stokes_i - model)
