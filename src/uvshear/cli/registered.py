"""Options whose value is a registered name, or the MODULE:NAME of an object of the user's own."""
# ruff: noqa: PLC0415  (help must not wait for imports)

from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Final

from uvshear.errors import InputError

if TYPE_CHECKING:
    from uvshear.galaxy import Profile

PROFILES: Final = "exponential, gaussian, sersic-2, disc-bulge, or MODULE:NAME of your own"
"""The package's own profiles, for help; those that other packages register are known too."""


@contextmanager
def named_by(option: str, name: str) -> Iterator[None]:
    """Let errors about an unknown name, or one that cannot be imported, begin with its option."""
    try:
        yield
    except InputError as error:
        raise InputError(f"{option} {name}: {error}") from error


def profile_named_by_option(name: str) -> "Profile":
    """Return the profile that ``--profile`` names."""
    from uvshear.galaxy.registry import profile_named

    with named_by("--profile", name):
        return profile_named(name)
