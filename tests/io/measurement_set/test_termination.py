"""The last words of a process that casacore ends."""

import contextvars
import subprocess
import sys
from pathlib import Path

import pytest

from tests.cli.processes import environment
from tests.io.measurement_sets import written
from uvshear.io.measurement_set.observation import MeasurementSet

TERMINATED = """
import ctypes
from pathlib import Path
from uvshear.io.measurement_set.opening import casacore_errors
from uvshear.io.measurement_set.termination import told_if_terminated
terminate = ctypes.CDLL("libstdc++.so.6")["_ZSt9terminatev"]
with told_if_terminated(Path("a.ms"), "the main table"):
    pass
{place}
    {inner}terminate()
"""


def _ended(*words: str, code: str | None = None) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-c", code] if code else [sys.executable, "-m", "uvshear", *words]
    return subprocess.run(
        command, capture_output=True, check=False, text=True, env=environment(), timeout=100
    )


def test_what_was_read_is_told() -> None:
    place = 'with casacore_errors(Path("b.ms"), "column DATA"):'
    inner = 'with told_if_terminated(Path("c.ms"), "x"): pass\n    '
    ended = _ended(code=TERMINATED.format(place=place, inner=inner))
    assert ended.returncode == 2
    assert ended.stderr == (
        "uvshear: error: b.ms: column DATA cannot be read; it is damaged, and casacore gave up\n"
    )


def test_a_reader_may_be_closed_in_another_context(tmp_path: Path) -> None:
    """Notebooks run each cell in a context of its own."""
    chunks = MeasurementSet(written(tmp_path), memory=10_000).chunks()
    contextvars.copy_context().run(next, chunks)
    contextvars.copy_context().run(chunks.close)


def test_the_end_by_another_library_is_not_blamed_on_a_set() -> None:
    ended = _ended(code=TERMINATED.format(place="if True:", inner=""))
    assert ended.returncode < 0
    assert "uvshear" not in ended.stderr


OPENED = """
import sys
from casacore import tables
try:
    tables.table(sys.argv[1], ack=False)
except RuntimeError:
    pass
"""


@pytest.fixture
def fatal(tmp_path: Path) -> Path:
    """A set with one wrong bit in table.dat, for which casacore terminates."""
    ms = written(tmp_path)
    clean = (ms / "table.dat").read_bytes()
    # Of several thousand bytes, one in ten is such a byte.
    for place in range(1451, len(clean), 37):
        damaged = bytearray(clean)
        damaged[place] ^= 0x40
        (ms / "table.dat").write_bytes(damaged)
        opened = [sys.executable, "-c", OPENED, str(ms)]
        if subprocess.run(opened, capture_output=True, check=False).returncode < 0:
            return ms
    pytest.fail("casacore terminates for none of these")


@pytest.mark.parametrize("command", ["info", "measure"])
def test_a_table_by_which_casacore_terminates_is_refused(fatal: Path, command: str) -> None:
    (fatal.parent / "cat.csv").write_text("id,l,m,flux\n1,0.0001,0,50\n")
    words = f"--catalogue {fatal.parent}/cat.csv --flux-unit uJy -o {fatal.parent}/o.fits"
    ended = _ended(command, str(fatal), *(words.split() if command == "measure" else ()))
    assert ended.returncode == 2
    assert ended.stderr == (
        f"uvshear: error: {fatal}: is damaged; casacore ended the process (SIGABRT) when it read the set\n"
    )
    assert {path.name for path in fatal.parent.iterdir()} == {"cat.csv", fatal.name}
