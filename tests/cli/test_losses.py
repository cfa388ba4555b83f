"""Averaging and primary beams by the command line: simulated, and measured again."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from astropy.table import Table
from casacore.tables import table

SIMULATE = (
    "--layout", "meerkat", "--declination-deg", "-30", "--hours", "0.5", "--integration-s", "300",
    "--band-mhz", "1000", "1001", "--no-noise",
)  # fmt: skip


@pytest.fixture
def catalogue(tmp_path: Path) -> Path:
    """Three galaxies, bright enough for their shapes, a third of a degree off."""
    path = tmp_path / "cat.ecsv"
    table = Table(
        {
            "l": np.array([0.006, -0.005, 0.0]),
            "m": np.array([0.0, 0.003, -0.006]),
            "flux": np.full(3, 1e-2),
            "scale_length": np.full(3, 6.0),
            "e1": np.array([0.3, -0.2, 0.0]),
            "e2": np.array([0.1, 0.1, -0.3]),
        },
        units={"l": "rad", "m": "rad", "flux": "Jy", "scale_length": "arcsec"},
    )
    table.write(path)
    return path


def _measured(uvshear: Callable, tmp_path: Path, catalogue: Path, *words: str) -> Table:
    output = tmp_path / "shapes.ecsv"
    outcome = uvshear(
        "measure", tmp_path / "field.ms", "--catalogue", catalogue, "-o", output, "--overwrite",
        "--size-prior", "catalogue", *words,
    )  # fmt: skip
    # What is not modelled leaves a residual beside every source.
    assert outcome.status == 0 or "flag is contaminated" in outcome.err, outcome.err
    return Table.read(output)


def test_what_was_averaged_and_seen_by_dishes_is_measured_as_it_is(
    uvshear: Callable, tmp_path: Path, catalogue: Path
) -> None:
    losses = ("--smearing", "--primary-beam", "meerkat")
    outcome = uvshear(
        *("simulate", "--catalogue", catalogue, *SIMULATE, *losses, "-o", tmp_path / "field.ms")
    )
    assert outcome.status == 0, outcome.err
    truth = Table.read(catalogue)
    right = _measured(uvshear, tmp_path, catalogue, "--primary-beam", "meerkat")
    assert np.abs(right["e1"] - truth["e1"]).max() < 5e-3
    np.testing.assert_allclose(right["flux_fit"], 1e4, rtol=0.01)
    wrong = _measured(uvshear, tmp_path, catalogue, "--no-smearing")
    assert np.abs(wrong["e1"] - truth["e1"]).max() > 0.02
    assert wrong["flux_fit"].max() < 9e3


def _point_north(path: Path, by: float, *columns: str) -> None:
    """Let the dishes of a set have pointed so far North of its phase centre, a direction cosine."""
    with table(str(path / "FIELD"), readonly=False, ack=False) as fields:
        for column in columns or ("REFERENCE_DIR", "DELAY_DIR"):
            direction = fields.getcell(column, 0)
            direction[0, 1] += np.arcsin(by)
            fields.putcell(column, 0, direction)


def test_pointings_that_disagree_are_refused(
    uvshear: Callable, tmp_path: Path, catalogue: Path
) -> None:
    for name in ("one.ms", "other.ms"):
        simulated = uvshear("simulate", "--catalogue", catalogue, *SIMULATE, "-o", tmp_path / name)
        assert simulated.status == 0, simulated.err
    words = ("--catalogue", catalogue, "-o", tmp_path / "s.ecsv", "--primary-beam", "meerkat")
    _point_north(tmp_path / "other.ms", 0.002)
    outcome = uvshear("measure", tmp_path / "one.ms", tmp_path / "other.ms", *words)
    assert outcome.status == 2
    assert "its dishes pointed in another direction than those of" in outcome.err
    _point_north(tmp_path / "one.ms", 0.002, "DELAY_DIR")
    outcome = uvshear("measure", tmp_path / "one.ms", *words)
    assert outcome.status == 2
    assert "REFERENCE_DIR and DELAY_DIR of FIELD are 413 arcsec apart" in outcome.err
    assert not (tmp_path / "s.ecsv").exists()


def test_dishes_look_where_they_pointed_whatever_the_phase_centre(
    uvshear: Callable, tmp_path: Path, catalogue: Path
) -> None:
    """A set observed with dishes that point elsewhere: fluxes become those of a beam that is elsewhere."""
    simulated = uvshear(
        *("simulate", "--catalogue", catalogue, *SIMULATE, "--primary-beam", "meerkat"),
        *("-o", tmp_path / "field.ms"),
    )
    assert simulated.status == 0, simulated.err
    moved = 0.004
    _point_north(tmp_path / "field.ms", moved)
    shapes = _measured(uvshear, tmp_path, catalogue, "--primary-beam", "meerkat")
    truth = Table.read(catalogue)
    width = np.radians(57.5 / 60) * 1.5e9 / 1.0005e9

    def power(l: np.ndarray, m: np.ndarray) -> np.ndarray:
        x = 1.18896 * np.hypot(l, m) / width
        return (np.cos(np.pi * x) / (1 - 4 * x**2)) ** 2

    l, m = truth["l"], truth["m"]
    expected = 1e4 * power(l, m) / power(l, m - moved)
    assert np.ptp(expected) > 2e3
    np.testing.assert_allclose(shapes["flux_fit"], expected, rtol=0.01)


def test_a_simulation_of_moments_is_not_taken_for_averages(
    uvshear: Callable, tmp_path: Path, catalogue: Path
) -> None:
    outcome = uvshear(
        *("simulate", "--catalogue", catalogue, *SIMULATE, "-o", tmp_path / "field.ms")
    )
    assert outcome.status == 0, outcome.err
    shapes = _measured(uvshear, tmp_path, catalogue)
    assert np.abs(shapes["e1"] - Table.read(catalogue)["e1"]).max() < 5e-3


def test_the_paper_has_no_primary_beam(uvshear: Callable, tmp_path: Path, catalogue: Path) -> None:
    outcome = uvshear(
        "measure", tmp_path / "field.ms", "--catalogue", catalogue, "-o", tmp_path / "s.ecsv",
        "--extraction", "paper", "--primary-beam", "airy",
    )  # fmt: skip
    assert outcome.status == 2
    assert "this extraction cannot model a primary beam; use --extraction converged" in outcome.err


def test_a_source_that_the_dishes_do_not_see_is_flagged(
    uvshear: Callable, tmp_path: Path, catalogue: Path
) -> None:
    table = Table.read(catalogue)
    table["l"][1] = 0.03
    table.write(catalogue, overwrite=True)
    beam = ("--primary-beam", "cosine-cubed")
    outcome = uvshear(
        *("simulate", "--catalogue", catalogue, *SIMULATE, *beam, "-o", tmp_path / "field.ms")
    )
    assert outcome.status == 0, outcome.err
    shapes = _measured(uvshear, tmp_path, catalogue, *beam)
    assert shapes["flag"].tolist() == ["ok", "outside_field", "ok"]
