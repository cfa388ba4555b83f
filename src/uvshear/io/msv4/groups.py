"""Groups of a zarr store, found by their metadata files; no package is needed for this."""

import json
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any, Final

from uvshear.errors import InputError

METADATA_FILES: Final = ("zarr.json", ".zgroup", ".zarray", ".zmetadata")
"""Files by which a directory is recognised as part of a zarr store: the first in format 3, the others in format 2."""

DEEPEST: Final = 4
"""Number of levels below a store in which groups of visibilities are looked for; converters use one or two."""

CORRELATED: Final = "visibility"
"""Attribute ``type`` of a group of visibilities."""


def is_zarr(path: Path) -> bool:
    """Tell whether a directory is part of a zarr store."""
    return any((path / name).is_file() for name in METADATA_FILES)


def correlated_groups(path: Path) -> tuple[Path, ...]:
    """Return the groups of visibilities of a store, which may be such a group itself.

    Raises
    ------
    InputError
        There is none, or the metadata cannot be read.
    """
    types: dict[Path, str] = {}
    for group in _groups(path, DEEPEST):
        types[group] = str(attributes(group).get("type", ""))
    if found := tuple(group for group, kind in types.items() if kind == CORRELATED):
        return found
    if "spectrum" in types.values():
        raise InputError(
            f"{path}: an MSv4 store of single-dish spectra; visibilities of an interferometer are needed"
        )
    if types.get(path, "") not in {"", "processing_set"}:
        raise InputError(
            f"{path}: an MSv4 group of the type '{types[path]}'; give the store itself, not one of its subgroups"
        )
    raise InputError(
        f"{path}: a zarr store, but not an MSv4 store (no group has the attribute type '{CORRELATED}')"
    )


def attributes(group: Path) -> Mapping[str, Any]:
    """Return the attributes of a group."""
    found = _read_json(group / "zarr.json")
    chosen = _read_json(group / ".zattrs") if found is None else found.get("attributes", {})
    return chosen if isinstance(chosen, dict) else {}


def _groups(path: Path, levels: int) -> Iterator[Path]:
    """Yield a group and those below it; below a group of visibilities there are no others of this type."""
    if not _is_group(path):
        return
    yield path
    if levels == 0 or attributes(path).get("type") == CORRELATED:
        return
    try:
        children = sorted(child for child in path.iterdir() if child.is_dir())
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror})") from error
    for child in children:
        yield from _groups(child, levels - 1)


def _is_group(path: Path) -> bool:
    found = _read_json(path / "zarr.json")
    if found is None:
        return (path / ".zgroup").is_file()
    return bool(found.get("node_type") == "group")


def _read_json(path: Path) -> dict[str, Any] | None:
    """Return the content of a metadata file; None if there is none."""
    if not path.is_file():
        return None
    try:
        content = json.loads(path.read_bytes())
    except (OSError, ValueError, RecursionError) as error:
        raise InputError(f"{path}: metadata that cannot be read ({error})") from error
    if not isinstance(content, dict):
        raise InputError(f"{path}: metadata that are not a JSON object")
    return content
