import numpy as np
import pytest

from uvshear.errors import InputError
from uvshear.galaxy import Galaxies


def three(**changes):
    columns = {
        "l": np.array([0.0, 0.1, 0.2]),
        "m": np.zeros(3),
        "flux": np.array([1e-5, 2e-5, 3e-5]),
        "scale_length": np.full(3, 5e-6),
        "ellipticity": np.array([0j, 0.3j, -0.5 + 0j]),
        "spectral_index": np.full(3, -0.7),
    }
    return Galaxies(**(columns | changes))


@pytest.mark.parametrize("index", [np.array([2, 0]), slice(1, None), np.array([True, False, True])])
def test_selection_takes_every_column_alike(index):
    galaxies = three()
    chosen = galaxies.select(index)
    assert len(chosen) == 2
    for name in ("l", "m", "flux", "scale_length", "ellipticity", "spectral_index"):
        np.testing.assert_array_equal(getattr(chosen, name), getattr(galaxies, name)[index])


def test_impossible_shapes_are_refused():
    with pytest.raises(InputError, match="ellipticity"):
        three(ellipticity=np.array([0j, 0j, 1 + 0j]))
    with pytest.raises(InputError, match="negative"):
        three(scale_length=np.array([1e-6, -1e-9, 0.0]))
