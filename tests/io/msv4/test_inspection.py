"""Inspection of a store, compared with that of the Measurement Set that it was made from."""

from dataclasses import asdict, replace

import numpy as np
import pytest
import xarray as xr
from casacore import tables

from tests.io.measurement_sets import change, written
from tests.io.msv4_stores import tree_of, write_tree
from uvshear.io.observations import inspect
from uvshear.io.reading import Reading


def test_a_store_tells_what_its_set_tells(original, store):
    seen, expected = inspect(store), inspect(original)
    assert seen.telescope == expected.telescope
    assert seen.columns == ("VISIBILITY",)
    for window, other in zip(seen.windows, expected.windows, strict=True):
        for name, value in asdict(other).items():
            np.testing.assert_array_equal(getattr(window, name), value)
    (content,), (other,) = seen.fields, expected.fields
    assert content.weight_column == "WEIGHT"
    assert content.quality == replace(other.quality, name=str(store))
    same = replace(content, weight_column=other.weight_column, quality=other.quality)
    assert same == other


def test_all_fields_are_inspected_or_one(tmp_path):
    ms = written(tmp_path)
    change(ms, "FIELD_ID", 1, rows=slice(0, 280))
    with tables.table(f"{ms}::FIELD", readonly=False, ack=False) as fields:
        fields.addrows(1)
        fields.putcell("NAME", 1, "calibrator")
        fields.putcell("PHASE_DIR", 1, fields.getcell("PHASE_DIR", 0))
    store = write_tree(tree_of(ms), tmp_path / "store")
    seen = inspect(store).fields
    assert [(field.number, field.name, field.counts.rows) for field in seen] == [
        (0, "simulated", 1400),
        (1, "calibrator", 280),
    ]
    (chosen,) = inspect(store, Reading(field="calibrator")).fields
    assert chosen.name == "calibrator"


@pytest.mark.usefixtures("tree")
def test_a_store_in_which_all_is_flagged_is_inspected_too(tree, write):
    tree["field_0"]["FLAG"] = xr.ones_like(tree["field_0"]["FLAG"])
    (content,) = inspect(write()).fields
    assert content.counts.usable == 0
    assert content.counts.flagged_fraction == 1
    assert content.noise is None
