"""Stores of which files are missing."""

import shutil

import numpy as np
import pytest

from uvshear.io.msv4.missing_parts import missing_parts
from uvshear.io.msv4.observation import Msv4Store


@pytest.fixture
def chunked(tree):
    tree["field_0"]["VISIBILITY"].encoding["chunks"] = (15, 28, 4, 2)


@pytest.mark.usefixtures("chunked")
@pytest.mark.parametrize("zarr_format", [2, 3])
def test_a_part_without_a_file_is_counted_and_told_of(write, zarr_format):
    path = write(zarr_format=zarr_format)
    assert missing_parts(path / "field_0", "VISIBILITY") == (0, 4)
    assert Msv4Store(path).notices() == ()
    variable = path / "field_0" / "VISIBILITY"
    if zarr_format == 3:
        shutil.rmtree(variable / "c" / "2")
    else:
        (variable / "2.0.0.0").unlink()
    assert missing_parts(path / "field_0", "VISIBILITY") == (1, 4)
    (notice,) = Msv4Store(path).notices()
    assert notice.startswith(
        "1 of the 4 zarr chunks of field_0/VISIBILITY have no file, as in an incomplete"
    )


def test_parts_may_be_kept_together_in_shards(tree, write):
    encoding = tree["field_0"]["VISIBILITY"].encoding
    encoding |= {"chunks": (10, 28, 4, 2), "shards": (30, 28, 4, 2)}
    path = write()
    missing, parts = missing_parts(path / "field_0", "VISIBILITY")
    assert (missing, parts) == (0, 6)
    shutil.rmtree(path / "field_0" / "VISIBILITY" / "c" / "1")
    assert missing_parts(path / "field_0", "VISIBILITY")[0] > 0
    assert len(np.concatenate([chunk.weights for chunk in Msv4Store(path).chunks()])) == 1680
