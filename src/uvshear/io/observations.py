"""Files of visibilities in any known format: opened as one observation, or inspected."""

from collections import deque
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack
from pathlib import Path
from typing import Final

from uvshear.errors import InputError
from uvshear.interferometer.joint_observation import JointObservation
from uvshear.interferometer.visibilities import Observation
from uvshear.io.inspection import Inspection
from uvshear.io.readers import reader_of
from uvshear.io.reading import Reading

AT_ONCE: Final = 16
"""Number of files that are begun to be opened before the first of them is complete."""


def open_observation(
    paths: str | Path | Sequence[str | Path],
    reading: Reading | None = None,
    prepared: Callable[[Observation], Observation] | None = None,
) -> Observation:
    """Open one file of visibilities, or several with the same phase centre; the reader is chosen by format.

    Parameters
    ----------
    paths
        One path or several.
    reading
        Options for reading: which visibilities of each file, and how.
    prepared
        Function that is applied to the observation of each file before the observations are joined.
    """
    reading = reading or Reading()
    chosen = [Path(paths)] if isinstance(paths, str | Path) else [Path(path) for path in paths]
    if not chosen:
        raise InputError("no file of visibilities is given; one or more are needed")
    resolved = [path.resolve() for path in chosen]
    for index, path in enumerate(resolved):
        if path in resolved[:index]:
            raise InputError(f"{chosen[index]}: is given twice; its visibilities would count twice")
    opened = list(_opened(chosen, reading))
    parts = opened if prepared is None else [prepared(observation) for observation in opened]
    return parts[0] if len(parts) == 1 else JointObservation.from_parts(parts)


def _opened(paths: Sequence[Path], reading: Reading) -> Iterator[Observation]:
    """Open files in their order; some of the next ones are begun meanwhile."""
    begun = deque[Callable[[], Observation]]()
    with ExitStack() as stack:
        for path in paths:
            if len(begun) == AT_ONCE:
                yield begun.popleft()()
            begun.append(stack.enter_context(reader_of(path, reading).begin(path, reading)))
        for complete in begun:
            yield complete()


def inspect(path: str | Path, reading: Reading | None = None) -> Inspection:
    """Read a file once for a summary of its content: all of its fields unless one is chosen."""
    reading = reading or Reading()
    return reader_of(Path(path), reading).inspect(Path(path), reading)
