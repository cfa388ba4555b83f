"""Ranges of rows of an observation."""

import pickle

import numpy as np
import pytest

from tests.io.measurement_sets import written
from uvshear.interferometer.origin import origin_of
from uvshear.interferometer.partitions import HasRows, partitions_of
from uvshear.interferometer.screening import screened_chunks
from uvshear.interferometer.visibilities import VisibilitySet
from uvshear.io.measurement_set.observation import MeasurementSet


@pytest.fixture(scope="module")
def field(tmp_path_factory) -> MeasurementSet:
    """1680 rows of four channels, of which a chunk has 84."""
    field = MeasurementSet(written(tmp_path_factory.mktemp("partitions")), memory=2**15)
    assert 60 < field.rows_per_chunk < 200
    return field


@pytest.mark.parametrize("samples", [1, 1000, 4 * 840, 10**9])
def test_partitions_have_the_chunks_of_the_whole(field, samples) -> None:
    parts = partitions_of(field, samples)
    found = [chunk for part in parts for chunk in screened_chunks(part)]
    for chunk, expected in zip(found, screened_chunks(field), strict=True):
        np.testing.assert_array_equal(chunk.uvw, expected.uvw)
        np.testing.assert_array_equal(chunk.stokes_i, expected.stokes_i)


def test_partitions_are_equal_and_as_large_as_allowed(field) -> None:
    chunk = field.rows_per_chunk
    for samples in (1, 3 * 4 * chunk, 4 * field.rows // 3):
        sizes = [part.stop - part.first for part in partitions_of(field, samples)]
        assert sum(sizes) == field.rows
        assert len(set(sizes[:-1])) == 1
        assert sizes[0] - sizes[-1] < chunk * len(sizes)
        assert sizes[0] * 4 < samples + 4 * chunk
    assert len(partitions_of(field, 10**9)) == 1
    assert partitions_of(field, 10**9)[0].samples == 4 * field.rows


def test_a_partition_is_sent_without_its_visibilities(field) -> None:
    part = partitions_of(field, 1000)[1]
    message = pickle.dumps(part)
    assert len(message) < 20_000
    received = pickle.loads(message)
    for chunk, expected in zip(received.chunks(), part.chunks(), strict=True):
        np.testing.assert_array_equal(chunk.stokes_i, expected.stokes_i)
    assert received.phase_centre == field.phase_centre
    assert origin_of(received).name == str(field.path)


def test_what_is_in_memory_has_no_such_rows(field) -> None:
    assert isinstance(field, HasRows)
    held = VisibilitySet(field.phase_centre, tuple(field.chunks()))
    assert not isinstance(held, HasRows)
