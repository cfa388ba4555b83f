"""Measurement Sets that pyuvdata has read, phased, conjugated or averaged, and written."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from tests.io.measurement_set.rewritten_fields import (
    changes,
    check_same_samples,
    samples_of,
    shapes_of,
    write_field,
    write_snapshots,
)
from tests.other_programs import run_pyuvdata
from uvshear.errors import DataWarning
from uvshear.io.observations import inspect

pytestmark = [pytest.mark.referee, pytest.mark.xdist_group("pyuvdata")]

REWRITE = """
early, snapshots = (UVData.from_file(f"{name}.ms", file_type="ms") for name in ("early", "snapshots"))
early.write_ms("written.ms")
one = early.copy()
one.conjugate_bls("ant2<ant1")
one.write_ms("conjugated.ms")
for frame in ("icrs", "fk5"):
    one = snapshots.copy()
    one.phase(ra=0.3001, dec=0.698, phase_frame=frame, epoch=2000.0, cat_name=frame, use_ant_pos=False)
    one.write_ms(f"{frame}.ms")
one = early.copy()
one.downsample_in_time(n_times_to_avg=2)
one.frequency_average(2)
one.write_ms("averaged.ms")
"""


@pytest.fixture(scope="module")
def sets(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Directory of what pyuvdata has written."""
    directory = tmp_path_factory.mktemp("pyuvdata")
    write_field(directory / "early.ms", (-0.5, 0.1))
    write_snapshots(directory / "snapshots.ms")
    run_pyuvdata(REWRITE, directory)
    return directory


def test_visibilities_that_were_only_written_are_the_same(sets: Path) -> None:
    early = samples_of(sets / "early.ms")
    check_same_samples(samples_of(sets / "written.ms"), early)
    assert inspect(sets / "written.ms").fields[0].warnings == ()


def test_antennas_may_be_in_the_other_order(sets: Path) -> None:
    """pyuvdata then has UVW = X(ANTENNA2) - X(ANTENNA1), as some telescopes do."""
    early, swapped = samples_of(sets / "early.ms"), samples_of(sets / "conjugated.ms")
    assert np.all(swapped.antennas[:, 0] > swapped.antennas[:, 1])
    check_same_samples(replace(swapped, antennas=swapped.antennas[:, ::-1]), early)
    assert inspect(sets / "conjugated.ms").fields[0].uvw_agrees is False


@pytest.mark.parametrize("frame", ["icrs", "fk5"])
def test_a_moved_phase_centre_moves_no_shape(sets: Path, frame: str) -> None:
    """By 0.03 of the errors, for a move of 31 arcsec; ICRS and FK5 differ by 0.033 arcsec."""
    before, after = (shapes_of(sets / name) for name in ("snapshots.ms", f"{frame}.ms"))
    assert np.abs(changes(after, before)).max() < 0.1
    for name in ("dl", "dm"):
        np.testing.assert_allclose(after[name], before[name], rtol=0, atol=0.05, err_msg=name)


def test_weights_that_were_averaged_are_remarked_on(sets: Path) -> None:
    """pyuvdata takes the mean of the weights, not their sum: errors are twice what they should be."""
    before = shapes_of(sets / "early.ms")
    with pytest.warns(DataWarning, match=r"the noise is 0\.5\d* times what the weights claim"):
        found = shapes_of(sets / "averaged.ms")
    np.testing.assert_allclose(found["e1_err"], 2 * before["e1_err"], rtol=0.02)
    assert np.abs(changes(found, before)).max() < 0.5
