"""The tree itself: tests mirror the package, and what one place shall do is done in one place."""

import ast
import re
import tomllib
from collections import Counter
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
PACKAGE = ROOT / "src" / "uvshear"
MODULES = sorted(path for path in PACKAGE.rglob("*.py") if path.stem != "__init__")

TESTED_ELSEWHERE = {
    "__main__.py": "`python -m uvshear` is tested with the command line.",
    "**/kernels.py": "Compiled loops are tested through the module that calls them.",
    "cli/*.py": "Commands and their options are tested by running the commands.",
    "compilation.py": "The decorator of the kernels holds no logic.",
    "constants.py": "Constants have no behaviour.",
    "errors.py": "Exceptions have no behaviour.",
    "progress/observer.py": "The abstract class is tested with its observers.",
    "typing.py": "Names of types have no behaviour.",
    "**/executor.py": "The abstract class is tested with its executors.",
    "extraction/extraction.py": "The protocol is tested with its algorithms.",
}
"""Modules without a test file of their own, and why."""

WORK_SIDE_BY_SIDE = re.compile(
    r"ThreadPoolExecutor|ProcessPoolExecutor|concurrent\.futures|\bmultiprocessing\b|threadpoolctl"
    r"|^\s*(?:import|from) threading\b|\bthreads\s*[:=]|\bnthreads\s*="
)
GRIDDER_THREADS = re.compile(r"nthreads\s*=\s*1\b")
"""A call of a library that is told to start no threads of its own."""

ALLOWED_ROOMS = ("execution", "cli")


def _relative(path: Path) -> str:
    return path.relative_to(PACKAGE).as_posix()


def _is_tested_elsewhere(path: Path) -> bool:
    inside = path.relative_to(PACKAGE)
    return any(_matches(inside, pattern) for pattern in TESTED_ELSEWHERE)


def _matches(path: Path, pattern: str) -> bool:
    """Match from the package's root; ``**/`` stands for any folder."""
    if pattern.startswith("**/"):
        return path.match(pattern.removeprefix("**/"))
    return path.match(pattern) and len(path.parts) == len(Path(pattern).parts)


@pytest.mark.parametrize("module", MODULES, ids=_relative)
def test_a_module_has_a_test_file_of_its_own(module):
    inside = module.relative_to(PACKAGE)
    mirror = ROOT / "tests" / inside.parent / f"test_{inside.name}"
    assert mirror.exists() or _is_tested_elsewhere(module)


def test_a_module_that_is_listed_as_tested_elsewhere_exists():
    modules = [module.relative_to(PACKAGE) for module in MODULES]
    idle = [p for p in TESTED_ELSEWHERE if not any(_matches(module, p) for module in modules)]
    assert idle == []


def test_work_side_by_side_is_arranged_in_one_room():
    found = [
        f"{_relative(module)}:{number}: {line.strip()}"
        for module in MODULES
        if module.relative_to(PACKAGE).parts[0] not in ALLOWED_ROOMS
        for number, line in enumerate(module.read_text(encoding="utf-8").splitlines(), 1)
        if WORK_SIDE_BY_SIDE.search(GRIDDER_THREADS.sub("", line))
    ]
    assert found == []


def test_the_import_contract_has_no_exceptions():
    configuration = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    importlinter = configuration["tool"]["importlinter"]
    (contract,) = importlinter["contracts"]
    assert contract["exhaustive"] is True
    for table in (importlinter, contract):
        assert {key for key in table if "ignore" in key} == set()
    assert {key for key in importlinter if key.startswith("exclude")} == set()


def _nodes(kind: type[ast.AST]) -> Iterator[tuple[Path, ast.AST]]:
    for module in sorted(PACKAGE.rglob("*.py")):
        for node in ast.walk(ast.parse(module.read_text(encoding="utf-8"))):
            if isinstance(node, kind):
                yield module, node


def test_no_name_is_given_to_two_classes():
    counted = Counter(node.name for _, node in _nodes(ast.ClassDef))
    assert [name for name, count in counted.items() if count > 1] == []


def test_methods_say_what_they_do():
    """``of`` would construct, evaluate or estimate."""
    found = [
        f"{_relative(path)}:{n.lineno}" for path, n in _nodes(ast.FunctionDef) if n.name == "of"
    ]
    assert found == []


def _help_texts() -> Iterator[tuple[str, str]]:
    import typer

    from uvshear.cli.application import app

    group = typer.main.get_command(app)
    for name, command in group.commands.items():
        yield name, command.help or ""
        for parameter in command.params:
            yield f"{name} {parameter.opts[-1]}", getattr(parameter, "help", None) or ""


def test_no_help_text_begins_in_the_middle_of_a_sentence():
    unclear = re.compile(r"(Of|How|By)\b")
    assert [f"{name}: {text}" for name, text in _help_texts() if unclear.match(text.strip())] == []


def test_every_option_and_every_command_has_a_help_text():
    assert [name for name, text in _help_texts() if not text and not name.endswith("--help")] == []


def test_the_list_of_slow_tests_names_tests_that_exist():
    listed = (ROOT / "tests" / "slow_tests.txt").read_text(encoding="utf-8").split()
    missing = []
    for name in listed:
        path, _, function = name.partition("::")
        file = ROOT / path
        if not file.exists() or f"def {function}(" not in file.read_text(encoding="utf-8"):
            missing.append(name)
    assert missing == []


@pytest.mark.parametrize("module", MODULES, ids=_relative)
def test_a_file_has_fewer_than_four_hundred_lines(module):
    assert len(module.read_text(encoding="utf-8").splitlines()) <= 400
