"""Chunks that are counted."""

from tests.interferometer.chunks import observation
from uvshear.interferometer.counted import counted


def test_a_chunk_counts_when_it_has_been_worked_on():
    told = []
    chunks = counted(observation(1, 2).chunks(), told.append)
    first = next(chunks)
    assert told == []
    rest = list(chunks)
    assert told == [each.stokes_i.size for each in (first, *rest)]
    assert len(told) == 2
