"""Tables that are written, and tables that cannot be written."""

import subprocess
import sys
from pathlib import Path

import numpy as np
from casacore import tables

from tests.cli.processes import environment
from uvshear.io.measurement_set.writing import written

PROGRAM = """
import resource, shutil, sys
import numpy as np
from casacore import tables
from uvshear.io.measurement_set.writing import written
description = tables.maketabdesc(tables.makearrcoldesc("DATA", 0.0, shape=[1000]))
try:
    with written(tables.table(sys.argv[1], description, nrow=100, ack=False)) as table:
        resource.setrlimit(resource.RLIMIT_FSIZE, (2000, resource.RLIM_INFINITY))
        table.putcol("DATA", np.ones((100, 1000)))
        table.flush()
except RuntimeError:
    shutil.rmtree(sys.argv[1])
    del table
    resource.setrlimit(resource.RLIMIT_FSIZE, (resource.RLIM_INFINITY,) * 2)
    print("refused")
"""


def test_a_table_that_cannot_be_written_does_not_end_the_process(tmp_path: Path) -> None:
    done = subprocess.run(
        [sys.executable, "-c", PROGRAM, tmp_path / "table"],
        capture_output=True,
        check=False,
        text=True,
        env=environment(),
    )
    assert (done.returncode, done.stdout, done.stderr) == (0, "refused\n", "")


def test_a_table_is_whole_after_the_block(tmp_path: Path) -> None:
    description = tables.maketabdesc(tables.makescacoldesc("DATA", 0.0))
    with written(tables.table(str(tmp_path / "table"), description, nrow=3, ack=False)) as table:
        table.putcol("DATA", np.arange(3.0))
    with tables.table(str(tmp_path / "table"), ack=False) as table:
        assert table.getcol("DATA").tolist() == [0.0, 1.0, 2.0]
