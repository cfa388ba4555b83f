"""The reader of Measurement Sets."""

from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import ClassVar

from uvshear.io.inspection import Inspection
from uvshear.io.measurement_set.inspection import inspect_measurement_set, observations_of
from uvshear.io.measurement_set.observation import MeasurementSet
from uvshear.io.measurement_set.trial import check_by_trial, trial
from uvshear.io.readers import Reader
from uvshear.io.reading import Reading


class MeasurementSetReader(Reader):
    """Opens Measurement Sets."""

    format: ClassVar[str] = "Measurement Set (a directory that holds table.dat)"

    def recognises(self, path: Path) -> bool:
        """Tell whether the path is a casacore table; :meth:`open` refuses other tables than Measurement Sets."""
        return (path / "table.dat").is_file()

    def open(self, path: Path, reading: Reading) -> MeasurementSet:
        """Open a set."""
        with self.begin(path, reading) as opened:
            return opened()

    @contextmanager
    def begin(self, path: Path, reading: Reading) -> Iterator[Callable[[], MeasurementSet]]:
        """Try a set while others are tried and opened."""

        def opened() -> MeasurementSet:
            wait()
            return MeasurementSet.from_reading(path, reading)

        def read() -> None:
            _read_a_little([MeasurementSet.from_reading(path, reading)])

        with trial(path, read) as wait:
            yield opened

    def inspect(self, path: Path, reading: Reading) -> Inspection:
        """Read a set once, all of its fields unless one is chosen."""
        check_by_trial(path, lambda: _read_a_little(observations_of(path, reading)))
        return inspect_measurement_set(path, reading)


def _read_a_little(observations: Iterable[MeasurementSet]) -> None:
    for observation in observations:
        next(observation.unchecked_chunks(), None)
