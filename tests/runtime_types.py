"""beartype for jaxtyping's import hook, which decorates methods singly and cannot know ``Self``."""

from collections.abc import Callable
from typing import Any

from beartype import beartype


def beartype_without_self(function: Callable[..., Any]) -> Callable[..., Any]:
    """Check every annotation but those that name ``typing.Self``."""
    function.__annotations__ = {
        name: Any if "typing.Self" in str(hint) else hint
        for name, hint in function.__annotations__.items()
    }
    return beartype(function)
