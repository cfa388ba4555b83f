"""A sky without the prior on ellipticities moves towards the truth.

How much the statistics of a crowd lose without that is in ``tests/estimators/test_moments.py``.
"""

import numpy as np

from tests.extraction.converged.states import nothing, touching_pair
from uvshear.execution import SERIAL
from uvshear.extraction.converged.minor_cycle import run_minor_cycle
from uvshear.extraction.converged.release import RELEASES, release


def test_a_released_sky_moves_from_the_prior_to_the_truth():
    prepared = touching_pair(snr_factor=0.02)
    held = run_minor_cycle(prepared.state, 0.01, SERIAL, nothing, afresh=True).state
    released, moves = release(held, 0.005, SERIAL, nothing)
    truth = prepared.truth.ellipticity
    part_held, part_released = (
        np.abs(prepared.ellipticities(state)) / np.abs(truth) for state in (held, released)
    )
    assert np.all(part_held < 0.97)
    assert np.all(np.abs(part_released - 1) < 0.5 * np.abs(part_held - 1))
    assert len(moves) == RELEASES
    assert moves[0] > moves[1] > moves[2]
    # The sky that it begins with keeps its priors and its place.
    assert held.sources == prepared.state.sources
    changes = [released.change_of_unit([k], held.fits) for k in range(len(held.fits))]
    assert max(changes) > moves[1]
