"""The extent of an array: which lengths of UVW the positions of its antennas allow."""

from dataclasses import dataclass, field
from typing import Final

import numpy as np

from uvshear.typing import Array, Bool, Float, Int

LONGEST_BASELINE: Final = 1e9
"""Length beyond which a baseline cannot be real, if the extent of the array is not known [m]: more than twice the
distance of the Moon."""

TOLERANCE: Final = 0.01
"""Relative difference between the length of UVW and the distance of two antennas that is taken as agreement. Geodesy,
aberration and averaging cause less than 1e-3."""


@dataclass(frozen=True)
class ArrayExtent:
    """The extent of an array by the positions of its antennas.

    Parameters
    ----------
    longest_baseline
        Length that no baseline exceeds [m]: the largest distance between two antennas, plus one per cent, plus the
        diameter of a dish. None unless UVW is as long as the distance between the antennas in most compared rows.
    wrong_ratio
        Median ratio of the length of UVW to these distances, if the antennas stand on the Earth and most rows disagree
        with them; None otherwise. Positions that are missing or in another frame cannot be compared with UVW.
    positions
        Geocentric position of each antenna [m], with NaN where it is not known, if the distances between them are to
        hold for every row; None otherwise.
    margin
        Length by which UVW may differ from the distance of its antennas, beside one per cent [m]: the axes of a mount
        need not meet.
    """

    longest_baseline: float | None = None
    wrong_ratio: float | None = None
    positions: Float[Array, "antenna 3"] | None = field(default=None, repr=False, compare=False)
    margin: float = 0.0

    @property
    def notice(self) -> str | None:
        """What a user should know about a UVW that does not fit the antennas; None if it fits."""
        if self.wrong_ratio is None:
            return None
        return (
            f"UVW and the positions of the antennas disagree: the length of UVW is {self.wrong_ratio:.3g} times the"
            " distance of the antennas (median)"
        )

    def allows(
        self, uvw: Float[Array, "row 3"], antennas: Int[Array, "row 2"] | None
    ) -> Bool[Array, " row"]:
        """Tell which baselines the array can have.

        Parameters
        ----------
        uvw
            Baselines [m].
        antennas
            Numbers of the two antennas of each row; None where they are not known.
        """
        longest = LONGEST_BASELINE if self.longest_baseline is None else self.longest_baseline
        with np.errstate(all="ignore"):
            length = np.sqrt(np.einsum("ij,ij->i", uvw, uvw))
            allowed: Bool[Array, " row"] = (length > 0) & (length <= longest)
            if antennas is not None and self.positions is not None and len(antennas):
                is_known = (antennas >= 0) & (antennas < len(self.positions))
                is_placed: Bool[Array, " row"] = np.all(is_known, axis=1)
                first, second = np.where(is_known, antennas, 0).T
                apart = self.positions[first] - self.positions[second]
                distance = np.sqrt(np.einsum("ij,ij->i", apart, apart))
                # A distance of NaN allows every length.
                is_off = np.abs(length - distance) > TOLERANCE * distance + self.margin
                allowed &= ~(is_placed & is_off)
        return allowed
