"""The backend that the environment names."""

import subprocess
import sys

import pytest

from tests.cli.processes import environment

DRAWS = """
import os
from uvshear.plot import save
from uvshear.plot.figure import new_figure
from pathlib import Path
save(new_figure(1, 2.0, 2.0)[0], Path("picture.png"))
import matplotlib
print(os.environ.get("MPLBACKEND"), matplotlib.rcParams._get_backend_or_none())
"""


@pytest.mark.parametrize(
    ("named", "used"), [("no such backend", "None"), ("svg", "svg"), ("", "None")]
)
def test_a_picture_is_drawn_whatever_backend_is_named(tmp_path, named, used):
    done = subprocess.run(
        [sys.executable, "-c", DRAWS],
        capture_output=True,
        check=True,
        text=True,
        cwd=tmp_path,
        env=environment(MPLBACKEND=named),
    )
    assert done.stdout.strip() == f"{named} {used}".strip()
    assert done.stderr == ""
    assert (tmp_path / "picture.png").read_bytes().startswith(b"\x89PNG")
