"""The decorators that compile all numba kernels of the package, and the place where compiled code is kept."""

import hashlib
import os
import pickle
from collections.abc import Callable, Mapping
from contextlib import suppress
from functools import cache
from pathlib import Path
from typing import Any, Final, TypeAlias

import numba
from numba.core import caching

_njit: Callable[..., Any] = numba.njit

_OPTIONS: Final = {"fastmath": True, "error_model": "numpy", "nogil": True}
"""Kernels are vectorised (no check of divisions, sums in any order) and run without Python's lock."""

_Key: TypeAlias = tuple[Any, ...]
"""The types of the arguments, the processor, and hashes of the function's own code."""


def compiled(function: Callable[..., Any]) -> Callable[..., Any]:
    """Compile a kernel; its code is kept on disk where there is a place for it."""
    return _kept_on_disk(_njit(function, **_OPTIONS))


def inlined(function: Callable[..., Any]) -> Callable[..., Any]:
    """Compile a function that is called within loops which should vectorise."""
    return _kept_on_disk(_njit(function, inline="always", **_OPTIONS))


def _kept_on_disk(kernel: Any) -> Callable[..., Any]:
    # numba's own option `cache=True` raises an error where no directory can be written.
    with suppress(Exception):
        kernel._cache = KernelCache(kernel.py_func)
    return kernel


class _Implementation(caching.CompileResultCacheImpl):
    """numba's choice of a directory: NUMBA_CACHE_DIR, else beside the source, else in the user's own cache."""

    _locator_classes: list[Any] = [  # noqa: RUF012 - as numba has it
        caching.UserProvidedCacheLocator,
        caching.InTreeCacheLocator,
        # For a user without a home directory numba would create a directory called ~ in the current one.
        *([caching.UserWideCacheLocator] if os.path.isabs(os.path.expanduser("~")) else []),
    ]


class KernelCache(caching.FunctionCache):
    """numba's cache of compiled code, without which a kernel can always do.

    Code that cannot be read is compiled again, and code that cannot be written is used by this process alone: a disk
    may be full, and files may be damaged or disappear.
    """

    _impl_class = _Implementation

    def __init__(self, function: Callable[..., Any]) -> None:
        super().__init__(function)
        stamp = (self._impl.locator.get_source_stamp(), _source_of_all_kernels())
        self._cache_file = _Files(self._cache_path, self._impl.filename_base, stamp)

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        """Return the code for some types, or None."""
        with suppress(Exception):
            return super().load_overload(sig, target_context)
        return None

    def save_overload(self, sig: Any, data: Any) -> None:
        """Keep the code for some types, if possible."""
        with suppress(Exception):
            super().save_overload(sig, data)


class _Files(caching.IndexDataCacheFile):
    """Files of the code of one kernel: one for each combination of types, and an index with their checksums.

    numba numbers these files. Two processes that compile a kernel for different types at the same time can give both
    the same number, so that a later process would run the code of the wrong types.
    """

    def save(self, key: _Key, data: object) -> None:
        """Write the code of a key, and then the index. What another process adds meanwhile is compiled once more."""
        content = self._dump(data)
        name = f"{Path(self._index_name).stem}.{_digest(repr(key[:2]).encode())}.nbc"
        with self._open_for_write(self._data_path(name)) as file:
            file.write(content)
        self._save_index({**self._index(), key: (name, _digest(content))})

    def load(self, key: _Key) -> object:
        """Read the code of a key; None if it is not there, or damaged."""
        if key not in (index := self._index()):
            return None
        name, checksum = index[key]
        content = Path(self._data_path(name)).read_bytes()
        return pickle.loads(content) if _digest(content) == checksum else None

    def _index(self) -> Mapping[_Key, tuple[str, str]]:
        with suppress(Exception):
            return self._load_index()
        return {}


def _digest(content: bytes) -> str:
    return hashlib.sha256(content).hexdigest()[:16]


@cache
def _source_of_all_kernels() -> str:
    """Return a checksum of all kernels: the code of a kernel contains that of the functions which it calls."""
    files = sorted(Path(__file__).parent.rglob("kernels.py"))
    return _digest(b"".join(path.read_bytes() for path in files))
