"""Readers of visibilities by format: the base class, and the readers that are known.

A reader for another format takes one file:

.. code-block:: python

    from uvshear.io.readers import Reader

    class MyReader(Reader):
        format = "my format (a file that ends in .mine)"

        def recognises(self, path):
            return path.suffix == ".mine"

        def open(self, path, reading):
            return VisibilitySet(...)

It is found if an installed package registers it with an entry point of the group ``uvshear.readers``, or if
``Reading.reader`` names it. The observation that it returns needs a phase centre and chunks. For a primary beam it also
needs the members of ``interferometer.dishes.HasDishes``; its name in warnings comes from
``interferometer.origin.HasOrigin``.
"""

from abc import ABC, abstractmethod
from collections.abc import Callable
from contextlib import AbstractContextManager, nullcontext
from pathlib import Path
from typing import ClassVar

from uvshear.errors import InputError
from uvshear.interferometer.visibilities import Observation
from uvshear.io.inspection import Inspection, inspect_observation
from uvshear.io.reading import Reading
from uvshear.plugins import Registry

READERS = Registry(
    "reader",
    "uvshear.readers",
    {
        "measurement-set": "uvshear.io.measurement_set.reader:MeasurementSetReader",
        "msv4": "uvshear.io.msv4.reader:Msv4Reader",
    },
    {},
)
"""Every registered object is a :class:`Reader` or a class of readers that takes no argument."""


class Reader(ABC):
    """Opens files of one format."""

    format: ClassVar[str]
    """Name of the format, and what its files look like, for messages."""

    @abstractmethod
    def recognises(self, path: Path) -> bool:
        """Tell whether a file or directory is in this format, from its name or its first bytes."""

    @abstractmethod
    def open(self, path: Path, reading: Reading) -> Observation:
        """Open a file or directory of this format.

        Raises
        ------
        InputError
            The file is damaged, or it does not hold what the reading asks for. The message is one line that names the
            path.
        """

    def begin(
        self, path: Path, reading: Reading
    ) -> AbstractContextManager[Callable[[], Observation]]:
        """Begin to open a file, and return a context that yields a function which completes this.

        Meanwhile other files can be opened; a reader of files whose opening takes time may override this method.
        """
        return nullcontext(lambda: self.open(path, reading))

    def inspect(self, path: Path, reading: Reading) -> Inspection:
        """Read a file once for a summary of its content; by default the content that any observation has."""
        return inspect_observation(self.open(path, reading))


def reader_of(path: Path, reading: Reading) -> Reader:
    """Return the reader that the reading asks for, or the first that recognises the path.

    Raises
    ------
    InputError
        There is no such file, or no reader recognises it.
    """
    if reading.reader is not None:
        return _reader_named(reading.reader)
    if not path.exists():
        raise InputError(f"{path}: no such file; the path of a file of visibilities is needed")
    readers = [_reader_named(name) for name in READERS.names()]
    for reader in readers:
        if reader.recognises(path):
            return reader
    known = "; ".join(reader.format for reader in readers)
    raise InputError(
        f"{path}: not in a known format of visibilities; the known formats are: {known}"
    )


def _reader_named(name: object) -> Reader:
    found = READERS.find(name) if isinstance(name, str) else name
    reader = found() if isinstance(found, type) else found
    if not isinstance(reader, Reader):
        raise InputError(
            f"the reader '{name}' is not a Reader but has the type {type(reader).__name__}"
        )
    return reader
