"""Tables that cannot be written do not end the process."""

import subprocess
import sys
import textwrap

import pytest
from casacore import tables

from uvshear.io.measurement_set.writing import written

FULL = textwrap.dedent(
    """
    import resource, signal, sys
    import numpy as np
    from casacore import tables
    from uvshear.io.measurement_set.writing import written

    signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    resource.setrlimit(resource.RLIMIT_FSIZE, (100_000, resource.RLIM_INFINITY))
    description = tables.maketabdesc([tables.makescacoldesc("X", 0.0)])
    try:
        with written(tables.table(sys.argv[1], description, nrow=100_000, ack=False)) as table:
            table.putcol("X", np.ones(100_000))
    except RuntimeError:
        print("an exception")
    """
)


def test_what_was_put_is_there_after_the_block(tmp_path):
    description = tables.maketabdesc([tables.makescacoldesc("X", 0.0)])
    with written(tables.table(str(tmp_path / "t"), description, nrow=3, ack=False)) as table:
        table.putcol("X", [1.0, 2.0, 3.0])
    with tables.table(str(tmp_path / "t"), ack=False) as table:
        assert table.getcol("X").tolist() == [1.0, 2.0, 3.0]


def test_an_error_in_the_block_is_passed_on(tmp_path):
    description = tables.maketabdesc([tables.makescacoldesc("X", 0.0)])
    with (
        pytest.raises(ZeroDivisionError),
        written(tables.table(str(tmp_path / "t"), description, ack=False)),
    ):
        raise ZeroDivisionError


def test_a_full_disk_is_an_exception_and_not_the_end_of_the_process(tmp_path):
    done = subprocess.run(
        [sys.executable, "-c", FULL, str(tmp_path / "t")],
        check=False,
        capture_output=True,
        text=True,
    )
    assert (done.returncode, done.stdout) == (0, "an exception\n"), done.stderr
