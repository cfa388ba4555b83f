"""The reader of Measurement Sets."""

from pathlib import Path
from typing import ClassVar

from uvshear.io.inspection import Inspection
from uvshear.io.measurement_set.inspection import inspect_measurement_set
from uvshear.io.measurement_set.observation import MeasurementSet
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
        return MeasurementSet.from_reading(path, reading)

    def inspect(self, path: Path, reading: Reading) -> Inspection:
        """Read a set once, all of its fields unless one is chosen."""
        return inspect_measurement_set(path, reading)
