"""A catalogue of the whole sky, of which few sources are in the field."""

import tracemalloc

import numpy as np
import pytest

from tests.pipeline.fields import METHOD, MODEL
from uvshear.io.catalogue import Catalogue
from uvshear.pipeline.measure import measure

ROWS = 100_000


def _with_the_sky(catalogue: Catalogue, rows: int, seed: int = 1) -> tuple[Catalogue, np.ndarray]:
    """Return the catalogue among sources of the other half of the sky, and the rows at which it is."""
    rng = np.random.default_rng(seed)
    place = np.sort(rng.choice(rows, len(catalogue), replace=False))
    columns = {
        "identifier": np.array([f"x{k}" for k in range(rows)]),
        "flux": np.full(rows, 1e-3),
        "spectral_index": np.full(rows, -0.7),
        "ra": rng.uniform(0, 2 * np.pi, rows),
        "dec": np.radians(rng.uniform(-60, -50, rows)),
        "scale_length": np.full(rows, 1e-5),
    }
    for name, values in columns.items():
        values[place] = getattr(catalogue, name)
    return Catalogue(**columns), place


@pytest.fixture(scope="module")
def large(field):
    return _with_the_sky(field.catalogue, ROWS)


def test_its_shapes_are_those_of_the_sources_in_the_field_alone(field, large):
    catalogue, place = large
    alone = measure(field.observation, field.catalogue, model=MODEL, method=METHOD).shapes
    shapes = measure(field.observation, catalogue, model=MODEL, method=METHOD).shapes
    assert len(shapes) == ROWS
    for name in alone.colnames:
        if alone[name].dtype.kind == "f":
            # numpy multiplies the last elements of an array in another way than those before.
            np.testing.assert_allclose(shapes[name][place], alone[name], rtol=1e-14, err_msg=name)
        else:
            np.testing.assert_array_equal(shapes[name][place], alone[name], err_msg=name)
    others = np.delete(np.arange(ROWS), place)
    assert set(shapes["flag"][others]) <= {"outside_field", "below_horizon"}
    assert np.isnan(shapes["e1"][others]).all()
    assert not shapes["weight"][others].any()


def test_memory_grows_with_the_rows_of_the_tables_alone(field, large):
    """The table of shapes has 232 bytes a row: 348 were measured at the peak, and 1562 with an object a row."""
    catalogue, _ = large

    def peak(sources):
        tracemalloc.start()
        measure(field.observation, sources, model=MODEL, method=METHOD)
        highest = tracemalloc.get_traced_memory()[1]
        tracemalloc.stop()
        return highest

    assert (peak(catalogue) - peak(field.catalogue)) / ROWS < 700
