"""A small Measurement Set, its conversion to MSv4 in memory, and its writing."""

from collections.abc import Callable
from pathlib import Path

import pytest

from tests.io.measurement_sets import written
from tests.io.msv4_stores import Tree, tree_of, write_tree


@pytest.fixture(scope="session")
def original(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A simulated set of 28 baselines, 60 integrations and 4 channels, which no test changes."""
    return written(tmp_path_factory.mktemp("original"))


@pytest.fixture(scope="session")
def _converted(original: Path) -> Tree:
    return tree_of(original)


@pytest.fixture
def tree(_converted: Tree) -> Tree:
    """The groups of its conversion, which a test may change."""
    return {group: content.copy(deep=True) for group, content in _converted.items()}


@pytest.fixture
def store(tmp_path: Path, tree: Tree) -> Path:
    """The conversion as it is."""
    return write_tree(tree, tmp_path / "field.ps.zarr")


@pytest.fixture
def write(tmp_path: Path, tree: Tree) -> Callable[..., Path]:
    """Write the groups as the test has changed them."""

    def write_changed(**options: object) -> Path:
        return write_tree(tree, tmp_path / "changed.ps.zarr", **options)

    return write_changed
