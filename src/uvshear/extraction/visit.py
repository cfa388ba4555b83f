"""One visit of the visibilities: everything modelled is subtracted, and facets are gathered."""

from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor

import numpy as np

from uvshear.extraction.facets import FacetBuilder
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
    threads: int = 1,
    on_chunk: Callable[[int], None] | None = None,
) -> None:
    """Feed the residual of every chunk to the builders of the sources ``members`` of ``sky``.

    Memory is that of one chunk and of the facets, whatever the number of rows. ``on_chunk`` hears the
    number of rows of each chunk done.
    """
    models = [sky.select(np.array([member])) for member in members]
    with ThreadPoolExecutor(max(threads, 1)) as pool:
        for chunk in observation.chunks():
            residual = subtract_sky(chunk, sky, profile, threads)
            tasks = [
                pool.submit(builder.add, residual, model)
                for builder, model in zip(builders, models, strict=True)
            ]
            for task in tasks:
                task.result()
            if on_chunk is not None:
                on_chunk(len(chunk))


def subtract_sky(
    chunk: Visibilities, sky: Galaxies, profile: Profile, threads: int = 1
) -> Visibilities:
    """Return the visibilities less those of all models."""
    model = predict_visibilities(sky, chunk.uvw, chunk.frequency, profile, threads)
    return chunk.with_stokes_i(chunk.stokes_i - model)
