"""Profiles by their names on the command line."""
# ruff: noqa: PLC0415  (help must not wait for imports)

from enum import StrEnum
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from uvshear.galaxy.profile import Profile


class ProfileName(StrEnum):
    """A brightness profile."""

    EXPONENTIAL = "exponential"
    GAUSSIAN = "gaussian"
    SERSIC_2 = "sersic-2"
    DISC_BULGE = "disc-bulge"


def profile_of(name: ProfileName) -> "Profile":
    """Return the profile of a name."""
    from uvshear.galaxy import DiscBulge, Exponential, Gaussian, Sersic

    profiles: dict[ProfileName, Profile] = {
        ProfileName.EXPONENTIAL: Exponential(),
        ProfileName.GAUSSIAN: Gaussian(),
        ProfileName.SERSIC_2: Sersic(2.0),
        ProfileName.DISC_BULGE: DiscBulge(),
    }
    return profiles[name]
