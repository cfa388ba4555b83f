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


def profile_of(name: ProfileName) -> "Profile":
    """Return the profile of a name."""
    from uvshear.galaxy import Exponential, Gaussian

    return Gaussian() if name is ProfileName.GAUSSIAN else Exponential()
