"""What the README shows, runs."""

import re
from pathlib import Path

import numpy as np
from astropy import units
from astropy.table import Table

ROOT = Path(__file__).parents[1]


def test_the_python_of_the_readme_runs_and_recovers_a_bright_galaxy(tmp_path, monkeypatch, capsys):
    """Two galaxies at a signal-to-noise ratio of some hundreds: e to 0.05, the noise being 0.01."""
    code = re.search(r"```python\n(.*?)```", (ROOT / "README.md").read_text(), re.S).group(1)
    body = [line for line in code.splitlines() if line and not re.match("import|from", line)]
    assert len(body) <= 10
    monkeypatch.chdir(tmp_path)
    rng = np.random.default_rng(2)
    stations = rng.normal(size=(12, 2)) * 8000
    lines = [
        f"{5109224 + 0.5 * n:.3f} {2006790 + e:.3f} {-3239100 + 0.8 * n:.3f} 15"
        for e, n in stations
    ]
    (tmp_path / "ARRAY.txt").write_text("\n".join(lines) + "\n")
    catalogue = Table(
        {
            "l": [1e-3, -1e-3],
            "m": [5e-4, 2e-3],
            "flux": [500.0, 800.0] * units.uJy,
            "scale_length": [3.0, 3.6] * units.arcsec,
            "e1": [0.2, -0.3],
            "e2": [0.3, 0.1],
        }
    )
    catalogue.write(tmp_path / "CAT.fits")
    names: dict[str, object] = {}
    exec(compile(code, "README.md", "exec"), names)
    shapes = names["shapes"]
    assert list(shapes["flag"]) == ["ok", "ok"]
    np.testing.assert_allclose(shapes["e1"], catalogue["e1"], atol=0.05)
    np.testing.assert_allclose(shapes["e2"], catalogue["e2"], atol=0.05)
    assert "ShearEstimate" in capsys.readouterr().out


def test_the_command_lines_of_the_readme_exist():
    from uvshear.cli.application import app

    text = (ROOT / "README.md").read_text()
    table = set(re.findall(r"^\| `(\w+)` \|", text, re.M))
    commands = {info.name or info.callback.__name__ for info in app.registered_commands}
    assert table == commands
