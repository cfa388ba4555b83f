"""An observation from any form in which it may be given."""

from collections.abc import Sequence
from pathlib import Path
from typing import TypeAlias

from uvshear.errors import InputError
from uvshear.interferometer.visibilities import Observation
from uvshear.io.observations import open_observation

ObservationLike: TypeAlias = Observation | str | Path | Sequence[str | Path]
"""An observation, or the file or files that have it."""


def observation_of(given: ObservationLike) -> Observation:
    """Return an observation, which may be given as an object, or as the path or paths of its files."""
    if isinstance(given, str | Path | Sequence):
        return open_observation(given)
    if isinstance(given, Observation):
        return given
    raise InputError(
        f"{type(given).__name__}: an observation, or the path or paths of its files, is needed"
    )


def paths_of(given: ObservationLike) -> tuple[str, ...]:
    """Return the paths of an observation that is given as files; an observation in memory has none."""
    if isinstance(given, str | Path):
        return (str(given),)
    return tuple(str(path) for path in given) if isinstance(given, Sequence) else ()
