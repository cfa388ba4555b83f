"""What the README shows, runs."""

import ast
import re
from pathlib import Path

import numpy as np
import pytest
from astropy import units
from astropy.table import Table

import uvshear

ROOT = Path(__file__).parents[1]
README = (ROOT / "README.md").read_text(encoding="utf-8")
BLOCKS = re.findall(r"```python\n(.*?)```", README, re.S)

GALAXIES = 100
"""Of the bias, in place of README's thousands."""


@pytest.fixture
def field(tmp_path, monkeypatch):
    """FIELD.ms and CAT.fits, of six galaxies at signal-to-noise ratios of about a hundred, in the working directory."""
    from uvshear.io.measurement_set.writer import write_measurement_set

    monkeypatch.chdir(tmp_path)
    rng = np.random.default_rng(2)
    catalogue = Table(
        {
            "id": np.arange(1, 7),
            "l": np.array([1.0, -1.0, 0.3, -0.6, 1.4, 0.2]) * 1e-3,
            "m": np.array([0.5, 2.0, -0.8, -1.5, -0.4, 1.2]) * 1e-3,
            "flux": np.array([90.0, 120.0, 100.0, 110.0, 130.0, 95.0]) * units.uJy,
            "scale_length": np.array([3.0, 3.6, 3.2, 3.4, 3.8, 3.1]) * units.arcsec,
            "e1": rng.uniform(-0.3, 0.3, 6),
            "e2": rng.uniform(-0.3, 0.3, 6),
        }
    )
    catalogue.write("CAT.fits")
    centre = uvshear.PhaseCentre(0.0, -0.5)
    track = uvshear.Track.from_clock(centre, ((-7200, 7200),), 600)
    channels = uvshear.Channels.from_band(0.95e9, 1.19e9, 1)
    plan = uvshear.ObservingPlan(uvshear.load_layout("meerkat"), track, channels)
    write_measurement_set(tmp_path / "FIELD.ms", uvshear.simulate("CAT.fits", plan, seed=1))
    return catalogue


def test_the_python_of_the_readme_runs(field, capsys):
    names: dict[str, object] = {}
    for block in BLOCKS:
        code = re.sub(r"galaxies=\d+", f"galaxies={GALAXIES}", block)
        exec(compile(code, "README.md", "exec"), names)
        flags = list(names["m"].shapes["flag"])
        assert len(flags) == len(field)
        # The galaxies are exponential discs: a Moffat profile leaves something of them.
        assert "Moffat" in block or flags == ["ok"] * len(field)
    printed = capsys.readouterr().out
    assert "Measurement" in printed
    assert "moments" in printed
    assert abs(names["bias"].m).max() < 0.1
    assert Path("SHAPES.fits").exists()


@pytest.mark.parametrize("block", BLOCKS, ids=lambda block: block.strip().splitlines()[-1][:40])
def test_a_task_takes_five_lines_of_python_at_most(block):
    """Lines of code; imports, comments and blank lines aside."""
    imports = (ast.Import, ast.ImportFrom)
    body = [node for node in ast.parse(block).body if not isinstance(node, imports)]
    lines = {
        line
        for statement in body
        for node in ast.walk(statement)
        if hasattr(node, "lineno")
        for line in (node.lineno,)
    }
    assert len(lines) <= 5


def test_the_table_of_commands_is_that_of_the_command_line():
    from uvshear.cli.application import app

    table = set(re.findall(r"^\| `(\w+)` \|", README, re.M))
    commands = {info.name or info.callback.__name__ for info in app.registered_commands}
    assert table == commands


def test_what_the_readme_takes_from_uvshear_is_listed_by_dir():
    used = set(re.findall(r"\buvshear\.([A-Za-z_]\w*)", "".join(BLOCKS)))
    assert used - set(dir(uvshear)) == set()
