"""Remarks on the data, from checks whose failure does not end a measurement."""

from collections.abc import Callable, Sequence


def remarks(about: str, check: Callable[[], Sequence[str]]) -> tuple[str, ...]:
    """Return the lines that a check reports, or one line which says that the check could not be made.

    Parameters
    ----------
    about
        Quantity that is checked, as the subject of a sentence.
    check
        Function that compares the data with something, and returns a line for each fact that a user should know.
    """
    try:
        return tuple(check())
    except Exception as error:
        reason = " ".join(f"{type(error).__name__}: {error}".split())
        return (f"{about} could not be checked ({reason}); this does not change the measurement",)
