"""Kernels compute the same wherever their code is kept, and where it cannot be kept."""

import importlib.util
import itertools
import os
import subprocess
import sys
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest
from numba.core import config

from uvshear import compilation

SOURCE = "from uvshear.compilation import compiled\n\n@compiled\ndef twice(x):\n    return 2 * x\n"
NUMBER = itertools.count()


@pytest.fixture
def source(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """File of a kernel, of which Python keeps nothing."""
    monkeypatch.setattr(sys, "dont_write_bytecode", True)
    path = tmp_path / "package" / "kernels.py"
    path.parent.mkdir()
    path.write_text(SOURCE)
    return path


def _imported(source: Path) -> Any:
    """Return the kernel as a process does that imports it for the first time."""
    specification = importlib.util.spec_from_file_location(f"kernels{next(NUMBER)}", source)
    assert specification is not None
    assert specification.loader is not None
    module: ModuleType = importlib.util.module_from_spec(specification)
    specification.loader.exec_module(module)
    return module.twice


def _hits(kernel: Any) -> int:
    return sum(kernel._cache_hits.values())


@pytest.fixture
def place(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Directory for compiled code."""
    monkeypatch.setattr(config, "CACHE_DIR", str(tmp_path / "cache"))
    return tmp_path / "cache"


def test_code_is_compiled_once(source: Path, place: Path) -> None:
    first = _imported(source)
    assert first(3) == 6
    assert _hits(first) == 0
    assert [path.suffix for path in sorted(place.rglob("*.nb?"))] == [".nbc", ".nbi"]
    second = _imported(source)
    assert second(3) == 6
    assert _hits(second) == 1


@pytest.mark.parametrize("ending", [".nbc", ".nbi"])
def test_damaged_code_is_compiled_again(source: Path, place: Path, ending: str) -> None:
    assert _imported(source)(3) == 6
    (damaged,) = place.rglob(f"*{ending}")
    content = damaged.read_bytes()
    damaged.write_bytes(content[: len(content) // 2])
    _expect_repair(source)


def test_code_that_is_not_that_of_the_index_is_compiled_again(source: Path, place: Path) -> None:
    assert _imported(source)(3) == 6
    (own,) = place.rglob("*.nbc")
    source.write_text(SOURCE.replace("2 * x", "3 * x"))
    assert _imported(source)(3) == 9
    wrong = own.read_bytes()
    source.write_text(SOURCE)
    assert _imported(source)(3) == 6
    own.write_bytes(wrong)
    _expect_repair(source)


def _expect_repair(source: Path) -> None:
    again = _imported(source)
    assert again(3) == 6
    assert _hits(again) == 0
    repaired = _imported(source)
    assert repaired(3) == 6
    assert _hits(repaired) == 1


def test_code_is_compiled_again_after_a_change_of_any_kernel(
    source: Path, place: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert _imported(source)(3) == 6
    monkeypatch.setattr(compilation, "_source_of_all_kernels", lambda: "other")
    changed = _imported(source)
    assert changed(3) == 6
    assert _hits(changed) == 0


def test_two_first_runs_never_take_the_code_of_other_types(source: Path, place: Path) -> None:
    first, second = _imported(source), _imported(source)
    # Both have read the index before either writes it.
    first._cache._cache_file._index = second._cache._cache_file._index = dict
    assert first(3) == 6
    assert second(1.5) == 3.0
    later = _imported(source)
    # With the numbers that numba gives, one of the two is the code of the other.
    assert later(3) == 6
    assert later(1.5) == 3.0
    assert _hits(later) == 1


def test_kernels_work_where_no_code_can_be_kept(
    source: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    nowhere = tmp_path / "file"
    nowhere.touch()
    (source.parent / "__pycache__").touch()
    monkeypatch.setattr(config, "CACHE_DIR", str(nowhere))
    for name in ("HOME", "XDG_CACHE_HOME"):
        monkeypatch.setenv(name, str(nowhere))
    assert _imported(source)(3) == 6


def test_a_user_without_a_home_gets_no_directory_in_the_current_one(
    source: Path, tmp_path: Path
) -> None:
    (source.parent / "__pycache__").touch()
    # As it does for a number of a user whom the system does not know.
    program = "import os; os.path.expanduser = str; from kernels import twice; print(twice(3))"
    done = _run(program, source, tmp_path)
    assert done.stdout == "6\n"
    assert sorted(os.listdir(tmp_path)) == ["package"]


def test_a_full_disk_costs_no_result(source: Path, tmp_path: Path) -> None:
    program = (
        "import resource as r; r.setrlimit(r.RLIMIT_FSIZE, (100, r.RLIM_INFINITY))\n"
        "from kernels import twice; value = twice(3)\n"
        "r.setrlimit(r.RLIMIT_FSIZE, (r.RLIM_INFINITY,) * 2); print(value)"
    )
    done = _run(program, source, tmp_path)
    assert done.stdout == "6\n"
    left = [path.name for path in source.parent.rglob("*") if ".nb" in path.name]
    assert left == []


def _run(program: str, source: Path, directory: Path) -> subprocess.CompletedProcess[str]:
    """Run a program that imports the kernel, without a home directory."""
    package = Path(compilation.__file__).parents[1]
    environment = {
        "PATH": os.environ["PATH"],
        "PYTHONPATH": f"{package}{os.pathsep}{source.parent}",
        "PYTHONDONTWRITEBYTECODE": "1",
    }
    done = subprocess.run(
        [sys.executable, "-c", program],
        capture_output=True,
        check=False,
        text=True,
        cwd=directory,
        env=environment,
    )
    assert done.returncode == 0, done.stderr
    return done


def test_the_sum_of_a_kernel_of_the_package_is_numpys() -> None:
    from uvshear.galaxy.kernels import exponential_envelope

    assert isinstance(exponential_envelope._cache, compilation.KernelCache)
    q = np.linspace(0, 4, 9)
    np.testing.assert_allclose(exponential_envelope(q), (1 + q) ** -1.5, rtol=1e-12)
