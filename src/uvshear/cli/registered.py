"""Options whose value is a registered name, or MODULE:NAME of an object of the user's own."""

from collections.abc import Callable

import typer

from uvshear.errors import InputError
from uvshear.plugins import Registry


def known_in(
    *registries: Registry, besides: tuple[str, ...] = ()
) -> Callable[[str | None], str | None]:
    """Return a check that a name is in one of the registries, or is one of those ``besides``, or has a colon.

    The name alone is looked at: what it stands for is imported when the command runs.
    """

    def check(name: str | None) -> str | None:
        if name is None or ":" in name or name in besides:
            return name
        known = [
            *besides,
            *(one for registry in registries for one in (*registry.names(), *registry.aliases)),
        ]
        if name not in known:
            raise typer.BadParameter(f"'{name}' is not known; {', '.join(known)} are")
        return name

    return check


def import_named(registry: Registry, option: str, name: str) -> object:
    """Import what a name stands for; errors name the option."""
    try:
        return registry.find(name)
    except InputError as error:
        raise InputError(f"{option} {name}: {error}") from error
