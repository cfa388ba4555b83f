"""One visit of the visibilities: everything modelled is subtracted, and facets are gathered."""

from collections.abc import Callable, Sequence
from functools import partial

import numpy as np

from uvshear.execution import SERIAL, Executor
from uvshear.extraction.paper.facets import FacetBuilder
from uvshear.galaxy import Galaxies, Profile
from uvshear.interferometer.visibilities import Observation, Visibilities
from uvshear.predict import predict_visibilities
from uvshear.typing import Array, Int


def gather_facets(
    observation: Observation,
    sky: Galaxies,
    builders: Sequence[FacetBuilder],
    members: Int[Array, " member"],
    profile: Profile,
    *,
    executor: Executor = SERIAL,
    on_chunk: Callable[[int], None] | None = None,
) -> None:
    """Feed the residual of every chunk to the builders of the sources ``members`` of ``sky``.

    Memory is that of one chunk and of the facets, whatever the number of rows. ``on_chunk`` hears the
    number of rows of each chunk done.
    """
    models = [sky.select(np.array([member])) for member in members]
    for chunk in observation.chunks():
        residual = subtract_sky(chunk, sky, profile, executor)
        pairs = zip(builders, models, strict=True)
        for _ in executor.map(partial(_add, residual), pairs):
            pass
        if on_chunk is not None:
            on_chunk(len(chunk))


def _add(residual: Visibilities, pair: tuple[FacetBuilder, Galaxies]) -> None:
    builder, model = pair
    builder.add(residual, model)


def subtract_sky(
    chunk: Visibilities, sky: Galaxies, profile: Profile, executor: Executor = SERIAL
) -> Visibilities:
    """Return the visibilities less those of all models."""
    model = predict_visibilities(sky, chunk.uvw, chunk.frequency, profile, executor)
    return chunk.with_stokes_i(chunk.stokes_i - model)
