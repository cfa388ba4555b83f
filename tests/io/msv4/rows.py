"""All rows of an observation, for a comparison that does not depend on their order."""

import numpy as np


def rows_of(observation):
    """All rows in an order of their own: time, frequency, antennas; channels that a window lacks are 0."""
    chunks = list(observation.chunks())
    most = max(len(chunk.frequency) for chunk in chunks)

    def padded(values):
        return np.pad(values, [(0, 0), (0, most - values.shape[1])])

    found = {
        "uvw": [chunk.uvw for chunk in chunks],
        "stokes_i": [padded(chunk.stokes_i) for chunk in chunks],
        "weights": [padded(chunk.weights) for chunk in chunks],
        "frequency": [padded(np.tile(chunk.frequency, (len(chunk), 1))) for chunk in chunks],
        "width": [padded(np.tile(chunk.width, (len(chunk), 1))) for chunk in chunks],
    } | {
        name: [getattr(chunk.integrations, name) for chunk in chunks]
        for name in ("antennas", "time", "interval")
    }
    joined = {name: np.concatenate(values) for name, values in found.items()}
    order = np.lexsort((*joined["antennas"].T[::-1], joined["frequency"][:, 0], joined["time"]))
    return {name: values[order] for name, values in joined.items()}


def assert_same(store, measurement_set):
    """The same rows to the bit."""
    first, second = rows_of(store), rows_of(measurement_set)
    for name, expected in second.items():
        np.testing.assert_array_equal(first[name], expected, err_msg=name)
