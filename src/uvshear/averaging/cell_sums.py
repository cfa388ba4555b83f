"""The columns of the sums over the samples of a cell, each weighted.

Coordinates are counted from the middle of the cell, in units of its size.
"""

from typing import Final

WEIGHT: Final = 0
VISIBILITY: Final = slice(1, 3)
"""Real and imaginary part [Jy]."""
VISIBILITY_TIMES: Final = slice(3, 9)
"""Real and imaginary part times u, then v, then w."""
PLACE: Final = slice(9, 12)
"""u, v, w."""
SECOND: Final = slice(12, 18)
"""Products of two coordinates: uu, uv, uw, vv, vw, ww."""
THIRD: Final = slice(18, 28)
"""Products of three: uuu, uuv, uuw, uvv, uvw, uww, vvv, vvw, vww, www."""
FOURTH: Final = slice(28, 43)
"""Products of four: uuuu, uuuv, uuuw, uuvv, uuvw, uuww, uvvv, uvvw, uvww, uwww, vvvv, vvvw, vvww, vwww, wwww."""
FREQUENCY: Final = 43
"""Frequency over that in the middle of the sub-band."""
FREQUENCY_TIMES: Final = slice(44, 47)
"""The same times u, v, w."""
RELATIVE_WIDTH: Final = 47
"""Width of a channel over its frequency."""
TIME: Final = 48
"""Middle of the integration [s]."""
INTERVAL: Final = 49
"""Length of the integration [s]."""

COLUMNS: Final = 50
"""Number of the sums."""
