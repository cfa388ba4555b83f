"""Run-time checks of array types, switched on before any module of the package is imported; the list of slow tests.

``tests/slow_tests.txt`` lists the tests that take long, which ``make test-fast`` leaves out. All tests run with
``pytest -n auto -m "not referee" --record-slow`` measure it anew.
"""

import importlib.util
import os
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

import jaxtyping
import pytest
from threadpoolctl import threadpool_limits

from tests.clusters import Cluster, cluster
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


@pytest.fixture(autouse=True)
def _copies_at_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let copies do the work of tests, which this process would often end before it makes any."""
    monkeypatch.setattr("uvshear.execution.copied_crew.WORTH_COPIES", 0.0)


@pytest.fixture(scope="session")
def two_workers(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Cluster]:
    """A cluster whose workers no test may end."""
    with cluster(tmp_path_factory.mktemp("cluster")) as found:
        yield found


@pytest.fixture(scope="session")
def client(two_workers: Cluster) -> Iterator[Any]:
    """Return a client of the cluster whose workers no test may end."""
    from uvshear.execution import connected

    with connected(two_workers.address) as found:
        yield found


SLOW_TESTS = Path(__file__).parent / "slow_tests.txt"
SLOW_SECONDS = 0.5
"""Duration, with fixtures and all of its parameters, from which a test is slow."""

_seconds: dict[str, float] = {}


def pytest_addoption(parser: pytest.Parser) -> None:
    """Add the option that measures which tests are slow."""
    parser.addoption(
        "--record-slow",
        action="store_true",
        help=f"Write the list of slow tests, {SLOW_TESTS.name}.",
    )


def pytest_collection_modifyitems(items: Iterable[pytest.Item]) -> None:
    """Mark the tests of the list."""
    lines = SLOW_TESTS.read_text(encoding="utf-8").splitlines() if SLOW_TESTS.exists() else []
    slow = set(lines)
    for item in items:
        if _function(item.nodeid) in slow:
            item.add_marker(pytest.mark.slow)


def pytest_runtest_logreport(report: pytest.TestReport) -> None:
    """Add up the time of a test with its fixtures."""
    name = _function(report.nodeid)
    _seconds[name] = _seconds.get(name, 0.0) + report.duration


def pytest_sessionfinish(session: pytest.Session) -> None:
    """Write the list, if asked to, in the process that has seen all tests."""
    is_worker = hasattr(session.config, "workerinput")
    if session.config.getoption("--record-slow") and not is_worker:
        slow = sorted(name for name, seconds in _seconds.items() if seconds > SLOW_SECONDS)
        SLOW_TESTS.write_text("".join(f"{name}\n" for name in slow), encoding="utf-8")


def _function(nodeid: str) -> str:
    """Name of a test without its parameters."""
    return nodeid.partition("[")[0]
