"""What natural weights would make of a source, whatever baselines its shape is taken from."""

import math

import numpy as np

from uvshear.concurrency import in_order
from uvshear.constants import SPEED_OF_LIGHT
from uvshear.galaxy import Galaxies, Profile
from uvshear.geometry.ellipticity import quadratic_form
from uvshear.interferometer.visibilities import Observation, Visibilities
from uvshear.typing import Array, Float

SHORTEST, LONGEST = 1.0, 1e8
"""Lengths between which baselines are told apart [wavelengths]."""

PER_E_FOLD, PER_HALF_TURN = 40, 160
"""Cells of the map along the logarithm of the length, and along the angle: norms of galaxies with \\|e\\| <= 0.8 are
good to 1e-3."""


def natural_norms(
    observation: Observation, galaxies: Galaxies, profile: Profile, threads: int = 1
) -> Float[Array, " source"]:
    """<m, m> of each galaxy for unit flux over every visibility [Jy^-2]: snr = S sqrt<m, m>.

    From a map of the weights over the length (in logarithmic steps) and the angle of the baselines: a model's
    square has no phase, so that it hardly changes across a cell. The tilt of baselines seen from off the phase centre
    is left out.
    """
    weight, mean_u, mean_v, log_frequency = _weights_by_baseline(observation)
    form = np.stack(quadratic_form(galaxies.ellipticity, galaxies.scale_length), axis=-1)
    squares = 4 * math.pi**2 * np.stack([mean_u**2, mean_u * mean_v, mean_v**2])
    squares, weight = squares.astype(np.float32), weight.astype(np.float32)

    def norm(source: int) -> float:
        q = form[source].astype(np.float32) @ squares
        index, reference = galaxies.spectral_index[source], galaxies.reference_frequency
        gain = np.exp(2 * index * (log_frequency - math.log(reference))).astype(np.float32)
        return float(np.sum(weight * gain * profile.envelope(q) ** 2, dtype=float))

    return np.array(list(in_order(norm, range(len(galaxies)), threads)))


def _weights_by_baseline(observation: Observation) -> Float[Array, "4 cell"]:
    """Sum of the weights in cells of baselines, and their mean u, v [wavelengths] and ln(frequency / Hz)."""
    lengths = math.ceil(math.log(LONGEST / SHORTEST) * PER_E_FOLD)
    sums = np.zeros((4, lengths * PER_HALF_TURN))
    for chunk in observation.chunks():
        for chan, frequency in enumerate(chunk.frequency):
            _add(chunk, chan, float(frequency), sums)
    sums = sums[:, sums[0] > 0]
    sums[1:] /= sums[0]
    return sums


def _add(chunk: Visibilities, chan: int, frequency: float, sums: Float[Array, "4 cell"]) -> None:
    weight = chunk.weights[:, chan]
    u, v = chunk.uvw[:, :2].T * (frequency / SPEED_OF_LIGHT)
    # Of the pair u and -u one is enough.
    flipped = np.where((v < 0) | ((v == 0) & (u < 0)), -1.0, 1.0)
    u, v = u * flipped, v * flipped
    along = np.log(np.clip(np.hypot(u, v), SHORTEST, LONGEST * 0.999) / SHORTEST) * PER_E_FOLD
    angle = np.clip(np.arctan2(v, u) / math.pi * PER_HALF_TURN, 0, PER_HALF_TURN - 1)
    cell = along.astype(int) * PER_HALF_TURN + angle.astype(int)
    for row, value in enumerate((1.0, u, v, math.log(frequency))):
        sums[row] += np.bincount(cell, weight * value, sums.shape[1])
