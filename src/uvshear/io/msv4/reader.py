"""The reader of MSv4 stores."""

from pathlib import Path
from typing import ClassVar

from uvshear.io.inspection import Inspection
from uvshear.io.msv4.groups import is_zarr
from uvshear.io.msv4.inspection import inspect_store
from uvshear.io.msv4.observation import Msv4Store
from uvshear.io.readers import Reader
from uvshear.io.reading import Reading


class Msv4Reader(Reader):
    """Opens stores of Measurement Set version 4, for which xarray and zarr must be installed."""

    format: ClassVar[str] = "MSv4 (a directory in the zarr format)"

    def recognises(self, path: Path) -> bool:
        """Tell whether the path is part of a zarr store; :meth:`open` refuses other stores than MSv4."""
        return is_zarr(path)

    def open(self, path: Path, reading: Reading) -> Msv4Store:
        """Open a store."""
        return Msv4Store.from_reading(path, reading)

    def inspect(self, path: Path, reading: Reading) -> Inspection:
        """Read a store once, all of its fields unless one is chosen."""
        return inspect_store(path, reading)
