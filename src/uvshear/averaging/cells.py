"""Cells of (u, v, w) so small that the loss of amplitude of all sources of a field is modelled accurately."""

import math
from dataclasses import dataclass
from typing import Final, Self

from uvshear.errors import InputError

ACCURACY: Final = 2.5e-4
"""Default error of the modelled loss of a source at the edge of the field, for each axis along which its phase varies:
half a cell turns the phase by 0.46 rad."""

LEAST_ACCURATE: Final = 0.1
"""Largest error of the loss that may be asked for: half a cell turns the phase by 2.1 rad."""

WIDEST_FIELD: Final = math.radians(10)
"""Largest width of a field [rad]."""


@dataclass(frozen=True)
class Cells:
    """Sizes of the cells [wavelengths].

    Parameters
    ----------
    uv
        Length along u and along v.
    w
        Length along w.
    """

    uv: float
    w: float

    @classmethod
    def for_field(cls, width: float, accuracy: float = ACCURACY) -> Self:
        r"""Choose the largest cells for a field.

        Over half a cell along u, v or w, the phase of a source on the edge of the field turns by at most phi. The
        average of cos(x) over all x from -phi to phi is sin(phi)/phi. The Gaussian with which the loss is modelled
        (``attenuation.CellSmearing``) differs from it by

        .. math:: \exp(-\phi^2/6) - \frac{\sin\phi}{\phi} \approx \frac{\phi^4}{180}.

        Parameters
        ----------
        width
            Width of the field [rad]; sources are at most half as far from the phase centre.
        accuracy
            Error of the modelled loss at the edge of the field, for each axis along which the phase varies that much. A
            row of few samples, which are not spread evenly, may have a larger error.
        """
        if not 0 < width <= WIDEST_FIELD:
            raise InputError(
                f"a field {math.degrees(width) * 60:g} arcmin wide; more than 0 and at most"
                f" {math.degrees(WIDEST_FIELD) * 60:g} arcmin are possible"
            )
        if not 0 < accuracy <= LEAST_ACCURATE:
            raise InputError(
                f"an accuracy of {accuracy:g}; a number above 0 and up to {LEAST_ACCURATE:g} is needed"
            )
        radius = width / 2
        uv = (180 * accuracy) ** 0.25 / (math.pi * radius)
        # The phase is 2 pi w (n - 1), and n - 1 is -radius^2/2 there.
        return cls(uv, 2 * uv / radius)
