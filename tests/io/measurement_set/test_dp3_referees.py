"""Measurement Sets that DP3 has averaged by baseline, or compressed."""

from pathlib import Path

import numpy as np
import pytest

from tests.io.measurement_set.crossed_hands import with_crossed_hands
from tests.io.measurement_set.rewritten_fields import (
    Samples,
    changes,
    samples_of,
    shapes_of,
    write_field,
)
from tests.other_programs import run_dp3
from uvshear.io.observations import inspect

pytestmark = [pytest.mark.referee, pytest.mark.xdist_group("dp3")]


@pytest.fixture(scope="module")
def fine(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Set of four correlations."""
    directory = tmp_path_factory.mktemp("dp3")
    write_field(directory / "hands.ms", (-0.5, 0.1))
    with_crossed_hands(directory / "hands.ms", directory / "fine.ms")
    return directory / "fine.ms"


def _sums(samples: Samples) -> dict[tuple[int, int], np.ndarray]:
    """Sum of the weights of each baseline, and of the weights times UVW and times the visibilities."""
    baselines, which = np.unique(samples.antennas, axis=0, return_inverse=True)
    weighted = np.column_stack([np.ones(len(samples)), samples.uvw, samples.stokes_i])
    sums = np.zeros((len(baselines), weighted.shape[1]), complex)
    np.add.at(sums, which, samples.weights[:, None] * weighted)
    return dict(zip(map(tuple, baselines.tolist()), sums, strict=True))


def test_averages_that_depend_on_the_baseline_are_read(fine: Path) -> None:
    averaged = fine.with_name("bda.ms")
    run_dp3(
        f"msin={fine}",
        f"msout={averaged}",
        "steps=[bda]",
        "bda.type=bdaaverager",
        "bda.timebase=10000",
        "bda.frequencybase=10000",
        "bda.maxinterval=240",
        "bda.minchannels=2",
        directory=fine.parent,
    )
    before, after = samples_of(fine), samples_of(averaged)
    assert np.unique(after.interval).tolist() == [60.0, 120.0, 180.0, 240.0]
    assert np.unique(after.width).tolist() == [5e6, 10e6, 15e6, 20e6]
    (content,) = inspect(averaged).fields
    assert content.warnings == ()
    assert content.counts.usable == len(after)
    expected = _sums(before)
    for baseline, sums in _sums(after).items():
        np.testing.assert_allclose(sums, expected[baseline], rtol=1e-5)
    shapes, found = shapes_of(fine), shapes_of(averaged)
    # 0.22, which is 4e-4 in e; the errors grow to 1.008 of what they were
    assert np.abs(changes(found, shapes)).max() < 0.5
    assert np.all(found["e1_err"] < 1.02 * shapes["e1_err"])


def test_visibilities_that_are_compressed_have_their_shapes(fine: Path) -> None:
    compressed = fine.with_name("dysco.ms")
    run_dp3(
        f"msin={fine}",
        f"msout={compressed}",
        "steps=[]",
        "msout.storagemanager=dysco",
        directory=fine.parent,
    )
    before, after = samples_of(fine), samples_of(compressed)
    np.testing.assert_allclose(after.weights, before.weights, rtol=1e-3)
    noise = np.abs(after.stokes_i - before.stokes_i) * np.sqrt(before.weights)
    added = np.sqrt(np.mean(noise**2))
    assert 0 < added < 0.15  # 0.079 of the noise of the visibilities
    # The shapes move by as much of their errors, and not further.
    moved = changes(shapes_of(compressed), shapes_of(fine))
    assert np.abs(moved).max() < 4 * added
