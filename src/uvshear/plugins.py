"""Objects by name: those of the package, those that installed packages register, and those in a user's own file.

A package registers a profile, say, by an entry point of the group ``uvshear.profiles`` in its ``pyproject.toml``:

.. code-block:: toml

    [project.entry-points."uvshear.profiles"]
    moffat = "my_package.moffat:Moffat"

A name with a colon, ``my_file:Moffat``, names a module and an object in it. It needs no registration, and the module
may be in the current directory.
"""

import os
import sys
from collections.abc import Mapping
from dataclasses import dataclass
from importlib import import_module
from importlib.metadata import entry_points
from typing import Any

from uvshear.errors import InputError


@dataclass(frozen=True)
class Registry:
    """The objects of one kind, by name.

    Parameters
    ----------
    kind
        Name of the kind, for messages: "profile".
    group
        Group of the entry points by which packages register objects.
    own
        Places (``module:object``) of the objects of this package, by name.
    aliases
        Alternative names, with the name that each stands for.
    """

    kind: str
    group: str
    own: Mapping[str, str]
    aliases: Mapping[str, str]

    def names(self) -> tuple[str, ...]:
        """Return all registered names: first those of this package in their order, then those of entry points."""
        others = sorted(point.name for point in self._registered() if point.name not in self.own)
        return (*self.own, *others)

    def find(self, name: str) -> Any:
        """Import the object of a name.

        Raises
        ------
        InputError
            The name is not known, or its object cannot be imported.
        """
        name = self.aliases.get(name, name)
        place = self.own.get(name) or self._place_of(name)
        module, _, attribute = place.partition(":")
        try:
            return getattr(import_module(module), attribute)
        except (ImportError, AttributeError, ValueError) as error:
            raise InputError(f"the {self.kind} '{name}' cannot be imported: {error}") from error

    def _place_of(self, name: str) -> str:
        if ":" in name:
            # As `python` itself does, and workers of other processes after it.
            if (here := os.getcwd()) not in sys.path:
                sys.path.append(here)
            return name
        for point in self._registered():
            if point.name == name:
                return point.value
        raise InputError(
            f"'{name}' is not a known {self.kind}; the known names are {', '.join(self.names())}, and MODULE:NAME"
            " stands for an object of your own"
        )

    def _registered(self) -> list[Any]:
        """Return the entry points: where Dask has been imported, they are those of the package importlib_metadata."""
        return list(entry_points(group=self.group))
