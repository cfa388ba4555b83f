"""Take reproduced targets into the documentation, with the commit at which their records were written.

    uvshear reproduce TARGET --scale paper -o DIR
    python benchmarks/paper_page.py DIR [TARGET ...]

All targets of the directory are taken unless some are named. The page is written anew from all records in
``docs/paper``.
"""

import argparse
import json
import shutil
from collections.abc import Sequence
from pathlib import Path

from record import commit

from uvshear.io.outputs import write_json
from uvshear.reproduce.names import PAPER, TARGETS
from uvshear.reproduce.page import write_page
from uvshear.reproduce.reproduced_target import ReproducedTarget

PLACE = Path(__file__).parents[1] / "docs" / "paper"


def main() -> None:
    """Copy records and pictures, and write the page."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("directory", type=Path, help="directory of uvshear reproduce")
    parser.add_argument("targets", nargs="*", metavar="TARGET", help="name of a target")
    arguments = parser.parse_args()
    for name in arguments.targets:
        if name not in TARGETS or not (arguments.directory / f"{name}.json").exists():
            raise SystemExit(f"{arguments.directory}: has no target {name}")
    made_at = commit()
    for path in _records(arguments.directory, arguments.targets or TARGETS):
        _take(path, made_at)
    write_page(PLACE / "index.md", [ReproducedTarget.read(path) for path in _records(PLACE)])


def _records(directory: Path, names: Sequence[str] = tuple(TARGETS)) -> list[Path]:
    """Return the records that a directory has of some targets, in the order of the page."""
    paths = [directory / f"{name}.json" for name in TARGETS if name in names]
    return [path for path in paths if path.exists()]


def _take(path: Path, made_at: str) -> None:
    target = ReproducedTarget.read(path)
    if target.scale != PAPER:
        raise SystemExit(f"{path}: was run at the scale {target.scale}, not {PAPER}")
    record = json.loads(path.read_text(encoding="utf-8")) | {"commit": made_at}
    write_json(PLACE / path.name, record, overwrite=True)
    shutil.copy(path.parent / target.picture, PLACE / target.picture)


if __name__ == "__main__":
    main()
