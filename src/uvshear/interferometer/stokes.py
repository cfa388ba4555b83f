"""Stokes I, with its weight, from the correlations of two feeds."""

from collections.abc import Sequence
from dataclasses import dataclass
from enum import Enum

import numpy as np

from uvshear.errors import InputError
from uvshear.typing import Array, Bool, Complex, Float

STOKES_I = 1
"""Code of Stokes I itself in a Measurement Set's CORR_TYPE (casacore, Stokes::StokesTypes)."""

CORRELATION_NAMES = {
    1: "I",
    5: "RR",
    6: "RL",
    7: "LR",
    8: "LL",
    9: "XX",
    10: "XY",
    11: "YX",
    12: "YY",
}
"""Names of CORR_TYPE codes (casacore, Stokes::StokesTypes)."""

CODES_OF_A_KIND = 4
"""Number of codes of each kind: 1 to 4 are the Stokes parameters, 5 to 8 those of circular feeds, and so on."""

HANDS_COMPARED = 2**14
"""Largest number of samples of a block at which the two hands are compared."""


class Hands(Enum):
    """The two parallel hands of each kind of feed, by their CORR_TYPE codes."""

    CIRCULAR = (5, 8)
    LINEAR = (9, 12)

    @property
    def receptors(self) -> tuple[str, str]:
        """Letters of the two receptors."""
        return ("R", "L") if self is Hands.CIRCULAR else ("X", "Y")


@dataclass(frozen=True)
class StokesI:
    """Stokes I of a block of rows.

    Parameters
    ----------
    visibilities
        Stokes I [Jy]; 0 where the weight is 0.
    weights
        1/sigma^2, with sigma the standard deviation of one real component [Jy^-2]; 0 where flagged or unusable.
    non_finite
        Number of unflagged samples with a NaN or an infinity in the data or weights of a hand.
    non_positive
        Number of unflagged finite samples with a zero or negative weight in a hand.
    hand_powers
        :func:`powers_of_hands` of some samples; None where a single correlation stands for Stokes I.
    """

    visibilities: Complex[Array, "row chan"]
    weights: Float[Array, "row chan"]
    non_finite: int
    non_positive: int
    hand_powers: Float[Array, " drawn"] | None = None


def parallel_hands(correlation_types: Sequence[int]) -> tuple[int, ...]:
    """Find the correlations that make Stokes I: Stokes I itself, two parallel hands, or one of them.

    Raises
    ------
    InputError
        There is none of these, or the types contradict one another: one occurs twice, or they are of several kinds of
        feeds.
    """
    types = list(correlation_types)
    kinds = {(code - 1) // CODES_OF_A_KIND for code in types}
    if len(kinds) > 1 or len(set(types)) < len(types):
        raise InputError(
            f"correlation types {types} cannot be those of one observation; different ones of one kind are needed:"
            " Stokes parameters (1 to 4), or correlations of circular (5 to 8) or of linear feeds (9 to 12)"
        )
    if STOKES_I in types:
        return (types.index(STOKES_I),)
    for hands in Hands:
        present = tuple(types.index(code) for code in hands.value if code in types)
        if present:
            return present
    raise InputError(
        f"correlation types {types} do not give Stokes I;"
        " I (1), or at least one of XX and YY (9, 12) or of RR and LL (5, 8), is needed"
    )


def stokes_i(
    correlations: Complex[Array, "row chan corr"],
    weights: Float[Array, "row chan corr"],
    flags: Bool[Array, "row chan corr"],
) -> StokesI:
    r"""Combine the correlations of :func:`parallel_hands`, one or two of them.

    .. math:: I = (p + q)/2, \qquad w_I = \frac{4}{1/w_p + 1/w_q}

    A single hand is taken as Stokes I. A visibility is left out if one of its hands is flagged or unusable.
    """
    flagged = flags[..., 0]
    finite = np.isfinite(correlations[..., 0]) & np.isfinite(weights[..., 0])
    positive = weights[..., 0] > 0
    if correlations.shape[-1] == 2:
        flagged = flagged | flags[..., 1]
        finite &= np.isfinite(correlations[..., 1]) & np.isfinite(weights[..., 1])
        positive &= weights[..., 1] > 0
    usable = ~flagged & finite & positive

    # Combine everywhere and zero the unusable after: cheaper than indexing.
    with np.errstate(all="ignore"):
        if correlations.shape[-1] == 2:
            visibilities = 0.5 * (correlations[..., 0] + correlations[..., 1])
            w_p, w_q = weights[..., 0], weights[..., 1]
            combined = 4 / (1 / w_p + 1 / w_q)
        else:
            visibilities = correlations[..., 0].copy()
            combined = weights[..., 0].copy()
    unusable = ~usable
    visibilities[unusable] = 0
    combined[unusable] = 0
    unflagged = ~flagged
    return StokesI(
        visibilities=visibilities,
        weights=combined,
        non_finite=int(np.count_nonzero(unflagged & ~finite)),
        non_positive=int(np.count_nonzero(unflagged & finite & ~positive)),
        hand_powers=powers_of_hands(correlations, combined)
        if correlations.shape[-1] == 2
        else None,
    )


def powers_of_hands(
    correlations: Complex[Array, "row chan 2"], weights: Float[Array, "row chan"]
) -> Float[Array, " drawn"]:
    r"""Power of the difference of the two hands over its variance, at samples drawn at random.

    .. math:: x = w_I |p - q|^2 / 4

    The difference (p - q)/2 has the noise of Stokes I but not its sky: it is Stokes Q of linear feeds, and Stokes V of
    circular ones. If the weights are right and the sky is not polarised, x/2 has an exponential distribution of mean 1.

    Parameters
    ----------
    weights
        Weights of Stokes I [Jy^-2].
    """
    size = weights.size
    if size <= HANDS_COMPARED:
        drawn = np.arange(size)
    else:
        # One at random in each of so many equal parts.
        part = np.random.default_rng(size).uniform(0, 1, HANDS_COMPARED)
        drawn = ((np.arange(HANDS_COMPARED) + part) * (size / HANDS_COMPARED)).astype(int)
    row, chan = np.unravel_index(drawn, weights.shape)
    used = weights[row, chan] > 0
    row, chan = row[used], chan[used]
    difference = correlations[row, chan, 0] - correlations[row, chan, 1]
    return np.abs(difference).astype(float) ** 2 * weights[row, chan] / 4
