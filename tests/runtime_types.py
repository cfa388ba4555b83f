"""beartype for jaxtyping's import hook, as far as annotations tell the truth at run time."""

from collections.abc import Callable
from typing import Any, Final

from beartype import BeartypeConf, beartype

UNKNOWABLE: Final = ("typing.Self", "typer.models.Context")
"""Not known to a method on its own; not what typer hands over (its own copy)."""

INT_SERVES_AS_FLOAT: Final = BeartypeConf(is_pep484_tower=True)


def beartype_what_is_knowable(function: Callable[..., Any]) -> Callable[..., Any]:
    """Check every annotation but those that name something unknowable, or what only type checkers import (text)."""
    function.__annotations__ = {
        name: Any
        if isinstance(hint, str) or any(word in str(hint) for word in UNKNOWABLE)
        else hint
        for name, hint in function.__annotations__.items()
    }
    return beartype(function, conf=INT_SERVES_AS_FLOAT)
