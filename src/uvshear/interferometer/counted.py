"""Chunks of visibilities that are counted while they are worked on."""

from collections.abc import Callable, Iterable, Iterator

from uvshear.interferometer.visibilities import Visibilities


def counted(
    chunks: Iterable[Visibilities], on_samples: Callable[[float], None]
) -> Iterator[Visibilities]:
    """Yield chunks, and tell the number of samples of each when the next one is asked for."""
    for seen in chunks:
        yield seen
        on_samples(seen.stokes_i.size)
