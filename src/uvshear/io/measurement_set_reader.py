"""The reader of Measurement Sets."""

from pathlib import Path
from typing import TYPE_CHECKING, ClassVar

from uvshear.io.measurement_set import MeasurementSet
from uvshear.io.readers import Reader, Reading

if TYPE_CHECKING:
    from uvshear.io.inspection import Inspection


class MeasurementSetReader(Reader):
    """Opens Measurement Sets."""

    format: ClassVar[str] = "Measurement Set (a directory that holds table.dat)"

    def recognises(self, path: Path) -> bool:
        """Tell whether the path is a casacore table; :meth:`open` refuses other tables than Measurement Sets."""
        return (path / "table.dat").is_file()

    def open(self, path: Path, reading: Reading) -> MeasurementSet:
        """Open a set."""
        return MeasurementSet(
            path,
            column=reading.column,
            field=reading.field,
            heeds_flags=reading.heeds_flags,
            scans=reading.scans,
            conjugates=reading.conjugates,
            subtracted=reading.subtracted,
        )

    def inspect(self, path: Path, reading: Reading) -> "Inspection":
        """Read a set once, all of its fields unless one is chosen."""
        from uvshear.io.measurement_set_inspection import inspect_measurement_set  # noqa: PLC0415

        return inspect_measurement_set(path, reading)
