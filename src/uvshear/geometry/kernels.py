"""Sine and cosine of phases of many turns, for compiled loops."""

import math

import numpy as np

from uvshear.compilation import inlined

# Coefficients of the Taylor series of sine and cosine, whose error is 4e-14 on [-pi/2, pi/2]. Loops around them
# vectorise, which those around the functions of the C library do not.
_S3, _S5, _S7, _S9, _S11, _S13, _S15, _S17 = (
    (-1) ** k / math.factorial(2 * k + 1) for k in range(1, 9)
)


@inlined
def sine_cosine_of_turns(turns):  # type: ignore[no-untyped-def]
    """Sine and cosine of 2 pi turns to 1e-13, without a branch, so that loops around them vectorise."""
    # The reduction to one turn comes first and in float64: |turns| reaches 1e4.
    half = math.pi * (turns - np.rint(turns))
    z = half * half
    s = half * (
        1
        + z
        * (
            _S3
            + z * (_S5 + z * (_S7 + z * (_S9 + z * (_S11 + z * (_S13 + z * (_S15 + z * _S17))))))
        )
    )
    c = _cosine(z)
    return 2 * s * c, 1 - 2 * s * s


_C2, _C4, _C6, _C8, _C10, _C12, _C14, _C16, _C18 = (
    (-1) ** k / math.factorial(2 * k) for k in range(1, 10)
)


@inlined
def _cosine(z):  # type: ignore[no-untyped-def]
    return 1 + z * (
        _C2
        + z
        * (
            _C4
            + z * (_C6 + z * (_C8 + z * (_C10 + z * (_C12 + z * (_C14 + z * (_C16 + z * _C18))))))
        )
    )


@inlined
def sine_cosine_of_turns_single(turns):  # type: ignore[no-untyped-def]
    """Sine and cosine of 2 pi turns to 2e-7, in single precision and half the time.

    The reduction to one turn is in the precision of the turns, which should be float64.
    """
    half = np.float32(math.pi * (turns - np.rint(turns)))
    z = half * half
    s = half * (_F1 + z * (_F3 + z * (_F5 + z * (_F7 + z * (_F9 + z * _F11)))))
    c = _F1 + z * (_F2 + z * (_F4 + z * (_F6 + z * (_F8 + z * (_F10 + z * _F12)))))
    return (s + s) * c, _F1 - (s + s) * s


_F1 = np.float32(1)
_F2, _F4, _F6, _F8, _F10, _F12 = (
    np.float32((-1) ** k / math.factorial(2 * k)) for k in range(1, 7)
)
# The first three are one to three units of the last place beside those of the Taylor series, so that the rounding of
# the cosine has a mean of 4e-9 and not of 3e-8, which would add up over the sources of a field.
_F3, _F5, _F7 = np.float32(-0.16666666), np.float32(0.008333331), np.float32(-0.00019841274)
_F9, _F11 = (np.float32((-1) ** k / math.factorial(2 * k + 1)) for k in (4, 5))
