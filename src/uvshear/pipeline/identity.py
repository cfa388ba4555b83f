"""What the state of a measurement depends on, in words: a run goes on only from a state of the same measurement."""

import hashlib
from collections.abc import Iterator, Mapping, Sequence, Set
from dataclasses import fields, is_dataclass
from datetime import datetime
from enum import Enum
from functools import cached_property
from importlib.metadata import version
from pathlib import Path
from typing import Any, Final

import numpy as np

from uvshear.execution.once import KeptOnce
from uvshear.extraction import MeasurementOptions, Method, Model
from uvshear.interferometer.first_pass import FirstPass
from uvshear.interferometer.origin import origin_of, parts_of
from uvshear.interferometer.visibilities import Observation
from uvshear.io.catalogue import Catalogue

_SHOWN: Final = 60
"""Longest text that is kept as it is; of a longer one, the beginning and a digest are kept."""

_DIGITS: Final = 16

_LOCKS: Final = frozenset({"table.lock"})
"""Files of a Measurement Set that casacore writes although the set is only read."""


def identity_of(
    observation: Observation, sources: Catalogue, options: MeasurementOptions
) -> dict[str, str]:
    """Return what is known before the visibilities are read: names that a user understands, and values.

    Neither the executor nor the memory is part of it, because the state does not depend on them.
    """
    found = {"the version of uvshear": version("uvshear")}
    parts = parts_of(observation)
    found["the number of observations"] = str(len(parts))
    for part in parts:
        name = origin_of(part).name
        if (path := Path(name)).exists():
            found[f"the content of {name}"] = _files(path)
        found[f"the selection from {name}"] = text_of(part)
    found["the catalogue"] = f"{len(sources)} sources ({_digest(canonical(sources))})"
    found |= _by_field("model", options.model) | _by_field("method", options.method)
    found["the list of statistics to keep"] = text_of(tuple(options.keep))
    return found


def content_of(first: FirstPass) -> dict[str, str]:
    """Return what is known after the first pass: the number of samples, and a digest of a random part of them."""
    digest = _digest(canonical((first.summary, first.noise_samples)))
    return {"the visibilities": f"{first.summary.samples} samples ({digest})"}


def text_of(value: object) -> str:
    """Return a text that differs if the value does."""
    try:
        text = canonical(value)
    except RecursionError:  # an object that contains itself
        text = type(value).__qualname__
    return text if len(text) <= _SHOWN else f"{text[:_SHOWN]}... ({_digest(text)})"


def canonical(value: Any) -> str:
    """Return all that a value consists of as a text, which is the same in every process.

    Objects are described by the arguments that made them if they are dataclasses, by their attributes otherwise;
    functions and classes by their names.
    """
    if value is None or isinstance(value, bool | int | float | complex | str | bytes):
        return repr(value)
    if isinstance(value, Path):
        return str(value.resolve())
    if isinstance(value, Enum):
        return str(value)
    if isinstance(value, np.ndarray | np.generic):
        array = np.ascontiguousarray(value)
        content = array.astype(str).tobytes() if array.dtype.hasobject else array.tobytes()
        return f"array({array.dtype}, {array.shape}, {_digest(content)})"
    if isinstance(value, type) or callable(getattr(value, "__code__", None)):
        return f"{value.__module__}.{value.__qualname__}"
    return "".join(_described(value))


def _by_field(name: str, options: Model | Method) -> dict[str, str]:
    return {f"{name}.{each.name}": text_of(getattr(options, each.name)) for each in fields(options)}


def _described(value: Any) -> Iterator[str]:
    if isinstance(value, Mapping):
        pairs = sorted(f"{canonical(key)}: {canonical(each)}" for key, each in value.items())
        yield "{" + ", ".join(pairs) + "}"
    elif isinstance(value, Set):
        yield "{" + ", ".join(sorted(map(canonical, value))) + "}"
    elif isinstance(value, Sequence):
        yield "(" + ", ".join(map(canonical, value)) + ")"
    else:
        if is_dataclass(value):
            # What does not count in a comparison of two objects has been computed from the rest.
            names = [each.name for each in fields(value) if each.init and each.compare]
        else:
            names = [
                name for name in sorted(getattr(value, "__dict__", {})) if _counts(value, name)
            ]
        given = ", ".join(f"{name}={canonical(getattr(value, name))}" for name in names)
        yield f"{type(value).__qualname__}({given})"


def _counts(value: object, name: str) -> bool:
    """Tell whether an attribute is given, and not a cached result."""
    is_cached = isinstance(getattr(type(value), name, None), cached_property)
    return not is_cached and not isinstance(getattr(value, name), KeptOnce)


def _digest(content: str | bytes) -> str:
    encoded = content.encode() if isinstance(content, str) else content
    return hashlib.sha256(encoded).hexdigest()[:_DIGITS]


def _files(path: Path) -> str:
    """Describe a file, or all files of a directory, by their number, their size and their last change."""
    files = [path] if path.is_file() else [each for each in path.rglob("*") if each.is_file()]
    known = [each.stat() for each in files if each.name not in _LOCKS]
    changed = max((each.st_mtime_ns for each in known), default=0)
    when = datetime.fromtimestamp(changed // 10**9).isoformat(sep=" ")
    return (
        f"{len(known)} files, {sum(each.st_size for each in known)} bytes, changed {when}"
        f".{changed % 10**9:09d}"
    )
