"""Run-time checks of array types, switched on before any module of the package is imported."""

import importlib.util
import os
from pathlib import Path

import jaxtyping
import pytest
from threadpoolctl import threadpool_limits

from tests.runtime_types import beartype_what_is_knowable

os.environ.setdefault("MPLBACKEND", "Agg")


def _leaf_modules() -> list[str]:
    """Every module but numba kernels and packages' ``__init__``, found without importing any.

    The hook matches by prefix: naming a package would take its kernels in.
    """
    specification = importlib.util.find_spec("uvshear")
    assert specification is not None
    assert specification.origin is not None
    root = Path(specification.origin).parent
    return [
        ".".join(("uvshear", *path.relative_to(root).with_suffix("").parts))
        for path in sorted(root.rglob("*.py"))
        if path.stem not in {"__init__", "kernels"}
    ]


jaxtyping.install_import_hook(
    _leaf_modules(), f"{beartype_what_is_knowable.__module__}.{beartype_what_is_knowable.__name__}"
)


@pytest.fixture(scope="session", autouse=True)
def _one_thread_for_linear_algebra():
    """As calibrations and extractions have it: workers of the tests share the cores as it is."""
    with threadpool_limits(1, user_api="blas"):
        yield
