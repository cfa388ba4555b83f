"""Chunks that are joined into blocks."""

from dataclasses import replace

import numpy as np

from uvshear.averaging.blocks import blocks_of
from uvshear.interferometer.visibilities import Integrations, Visibilities


def _chunk(rows: int, start: int, channels: int = 3) -> Visibilities:
    numbers = np.arange(start, start + rows)
    return Visibilities(
        uvw=np.column_stack([numbers, numbers + 1, numbers + 2]).astype(float),
        frequency=np.linspace(1e9, 1.1e9, channels),
        stokes_i=np.ones((rows, channels), np.complex64) * numbers[:, None].astype(np.complex64),
        weights=np.ones((rows, channels), np.float32),
        width=np.full(channels, 1e6),
        integrations=Integrations(
            np.column_stack([numbers, numbers + 1]), numbers + 0.5, np.ones(rows)
        ),
    )


def test_blocks_have_all_rows_in_their_order() -> None:
    chunks = [_chunk(4, start) for start in range(0, 20, 4)]
    blocks = list(blocks_of(chunks, samples=20))
    assert [len(block) for block in blocks] == [8, 8, 4]
    np.testing.assert_array_equal(np.concatenate([b.uvw[:, 0] for b in blocks]), np.arange(20))
    np.testing.assert_array_equal(
        np.concatenate([b.stokes_i[:, 2].real for b in blocks]), np.arange(20)
    )
    for name, expected in (("time", np.arange(20) + 0.5), ("interval", np.ones(20))):
        joined = np.concatenate([getattr(block.integrations, name) for block in blocks])
        np.testing.assert_array_equal(joined, expected)


def test_other_channels_begin_another_block() -> None:
    one, two = _chunk(4, 0), _chunk(4, 4, channels=2)
    wider = replace(two, width=2 * two.width)
    unknown = replace(two, integrations=None)
    sharp = replace(two, width=None)
    blocks = list(blocks_of([one, two, two, wider, unknown, sharp], samples=1000))
    assert [len(block) for block in blocks] == [4, 8, 4, 4, 4]
    assert [block.width is None for block in blocks] == [False, False, False, False, True]
    assert blocks[3].integrations is None
