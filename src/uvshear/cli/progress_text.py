"""Words about the course of a computation."""

from uvshear.progress import Course

MINUTE, HOUR, DAY = 60.0, 3600.0, 86400.0


def done_text(course: Course) -> str:
    """Return the share of the whole time that has passed; empty while it is not known."""
    # What is not finished is not 100 %.
    return f"{min(100 * course.share, 99):.0f} %" if course.share > 0 else ""


def rate_text(course: Course) -> str:
    """Return how fast the stage goes; empty while it is not known."""
    if not course.unit or (rate := course.rate) is None:
        return ""
    return f"{_number(rate)} {course.unit}/s"


def left_text(course: Course) -> str:
    """Return how long it will still take; empty while it is not known."""
    left = course.left
    if left is None:
        return ""
    if left < 5:
        return "a few seconds left"
    if left < 1.5 * MINUTE:
        return f"about {5 * round(left / 5)} s left"
    if left < 1.5 * HOUR:
        return f"about {left / MINUTE:.0f} min left"
    if left < 2 * DAY:
        return f"about {left / HOUR:.1f} h left"
    return f"about {left / DAY:.1f} days left"


def line_about(description: str, course: Course) -> str:
    """Return a line about a computation that has no terminal."""
    done = f"{done_text(course)} done" if done_text(course) else ""
    parts = (course.stage, done, rate_text(course), left_text(course))
    facts = ", ".join(part for part in parts if part)
    return f"uvshear: {description}: {facts}" if facts else f"uvshear: {description}"


def _number(value: float) -> str:
    if value >= 1e6:
        return f"{value / 1e6:.3g} million"
    if value >= 1e4:
        return f"{value / 1e3:.0f} thousand"
    return f"{value:.0f}" if value >= 100 else f"{value:.2g}"
