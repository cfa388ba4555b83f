"""The facets of some sources, gathered in one pass over the residual of all models."""

from collections.abc import Callable, Sequence
from typing import Self

from uvshear.execution import SERIAL, Executor
from uvshear.extraction.paper.facets import FacetBuilder
from uvshear.galaxy import Galaxies
from uvshear.interferometer.accumulate import Accumulator
from uvshear.interferometer.facet import Facet
from uvshear.interferometer.visibilities import Visibilities


class FacetAccumulator(Accumulator[list[Facet]]):
    """Passes every chunk of the residual to the builders of some sources.

    The memory is that of the facets, whatever the number of rows.

    Parameters
    ----------
    builders
        Builders of the facets.
    models
        Model of the source of each builder, which has been subtracted with all others.
    executor
        Executor of the builders.
    on_chunk
        Function called with the number of rows of each chunk.
    """

    def __init__(
        self,
        builders: Sequence[FacetBuilder],
        models: Sequence[Galaxies],
        executor: Executor = SERIAL,
        on_chunk: Callable[[int], None] | None = None,
    ) -> None:
        self._executor = executor
        self._pairs = list(zip(builders, models, strict=True))
        self._on_chunk = on_chunk

    def add(self, seen: Visibilities) -> None:
        """Pass a chunk of the residual to the builders."""

        def feed(pair: tuple[FacetBuilder, Galaxies]) -> None:
            builder, model = pair
            builder.add(seen, model)

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
