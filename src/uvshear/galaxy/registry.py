"""Brightness profiles by name: those of the package, those of installed packages, and those of a user's own file."""

from typing import Any

from uvshear.errors import InputError
from uvshear.galaxy.profile import Profile
from uvshear.galaxy.sersic import Sersic
from uvshear.plugins import Registry

PROFILES = Registry(
    "profile",
    "uvshear.profiles",
    {
        "exponential": "uvshear.galaxy.exponential:Exponential",
        "gaussian": "uvshear.galaxy.gaussian:Gaussian",
        "sersic-2": "uvshear.galaxy.registry:sersic_2",
        "disc-bulge": "uvshear.galaxy.sersic:DiscBulge",
    },
    {},
)
"""Every registered object is a :class:`Profile`, or a class or function that returns one without an argument."""


def profile_named(name: str) -> Profile:
    """Return the profile of a registered name, or of ``MODULE:NAME``."""
    found: Any = PROFILES.find(name)
    profile = found() if callable(found) and not isinstance(found, Profile) else found
    if not isinstance(profile, Profile):
        raise InputError(
            f"the profile '{name}' is not a Profile but has the type {type(profile).__name__}"
        )
    return profile


def sersic_2() -> Sersic:
    """Return the profile of Sersic index 2."""
    return Sersic(2.0)
