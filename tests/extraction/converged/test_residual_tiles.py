"""Images of tiles in parts, by several workers."""

import gc
import subprocess
import sys
import weakref
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from tests.extraction.converged.major_cycles import GRIDDING, MIXED, changed, small_field
from uvshear.execution import SERIAL, Threads
from uvshear.extraction.converged import residual_tiles
from uvshear.imaging.tangent import TangentPlane
from uvshear.predict import gridded

ROOT = Path(__file__).parents[3]
CHANNELS = np.array([1.05e9, 1.2e9, 1.4e9])


@pytest.fixture(scope="module")
def field():
    """A field whose tiles have several filters each."""
    return small_field(MIXED, CHANNELS, rows=500)


def _facets(field, executor):
    model = changed(MIXED, 1, flux=0.5)
    return field.residuals(model, replace(GRIDDING, executor=executor))


@pytest.mark.parametrize("executor", [SERIAL, Threads(2), Threads(5)])
def test_slabs_of_samples_add_up(field, executor, monkeypatch):
    whole = _facets(field, SERIAL)
    monkeypatch.setattr(gridded, "SLAB", 200)
    assert len(gridded.slabs(1500)) == 8
    in_parts = _facets(field, SERIAL)
    for part, expected in zip(in_parts, whole, strict=True):
        # measured 2e-5; one slab left out: 0.1
        assert np.linalg.norm(part - expected) < 1e-4 * np.linalg.norm(expected)
    for facet, expected in zip(_facets(field, executor), in_parts, strict=True):
        np.testing.assert_array_equal(facet, expected)


def test_an_error_in_one_tile_ends_the_work_of_all(field, monkeypatch):
    image = TangentPlane.image

    def failing(plane, vis, size, *rest):
        if np.abs(plane.baselines[:, :2]).max() > 3e4:
            raise ZeroDivisionError
        return image(plane, vis, size, *rest)

    monkeypatch.setattr(TangentPlane, "image", failing)
    with pytest.raises(ZeroDivisionError):
        _facets(field, Threads(2))


def test_images_are_discarded_when_they_are_no_longer_needed(field, monkeypatch):
    seen, cut = [], residual_tiles._cut

    def remember(images, tile, *rest):
        cut(images, tile, *rest)
        seen.append(images)

    made = []
    build = residual_tiles._tiles_of_bands

    def watched(residuals):
        made.append(build(residuals))
        return made[-1]

    monkeypatch.setattr(residual_tiles, "_cut", remember)
    monkeypatch.setattr(residual_tiles, "_tiles_of_bands", watched)
    _facets(field, SERIAL)
    (tiles,) = made
    assert len(tiles) > 1
    assert len(seen) == len(tiles[-1])
    assert all(images for images in seen)
    for of_band in tiles:
        for tile in of_band:
            assert not tile.images.is_held


@pytest.mark.parametrize("executor", [SERIAL, Threads(2)])
def test_samples_are_released_without_the_garbage_collector(field, executor, monkeypatch):
    """It looks seldom at what is old, and never at what was there when copies were made: blocks would pile up."""
    made = []
    build = residual_tiles._tiles_of_bands

    def watched(residuals):
        made.append(weakref.ref(residuals))
        return build(residuals)

    monkeypatch.setattr(residual_tiles, "_tiles_of_bands", watched)
    gc.disable()
    try:
        _facets(field, executor)
        (residuals,) = made
        assert residuals() is None
    finally:
        gc.enable()


WATCH_BLOCKS = """
import weakref

from tests.extraction.converged.major_cycles import SKY, small_field
from uvshear.extraction.converged import major_cycle

blocks, held = [], []
divide, image = major_cycle._parts, major_cycle.add_to_facets

def divided(samples, *rest):
    blocks.append(weakref.ref(samples))
    return divide(samples, *rest)

def imaged(*arguments):
    held.extend(block() is not None for block in blocks)
    return image(*arguments)

major_cycle._parts, major_cycle.add_to_facets = divided, imaged
small_field(rows=500).residuals(SKY)
print(held)
"""


def test_a_block_is_released_before_it_is_imaged():
    """The samples of its bands are copies. Where annotations are checked, as they are here, calls hold arguments."""
    command = [sys.executable, "-c", WATCH_BLOCKS]
    run = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True)
    assert run.stdout == "[False]\n"
