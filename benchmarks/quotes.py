"""Figures that the documentation quotes, compared with the records that they come from.

In the Markdown text a figure is followed by a comment that names its record and itself, and that no reader sees:

    0.995 ± 0.002<!-- crowded/slope_e1 -->

It is ``slope_e1`` of ``benchmarks/results/crowded.json``, and the error ``slope_e1_err``. The text has as many decimals
as the writer wants; the record's number, rounded to these, must be the text's.

    python benchmarks/quotes.py              list what differs
    python benchmarks/quotes.py --write      put the records' numbers into the text, decimals as they are

A figure that is not measured yet is written with question marks for digits (``?.??? ± ?.???``).
"""

import json
import re
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).parents[1]
RESULTS = ROOT / "benchmarks" / "results"
PAGES = (ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md")))

NUMBER = r"[-+−]?[\d?]+(?:\.[\d?]+)?(?:e-?\d+)?"
QUOTE = re.compile(
    rf"(?P<value>{NUMBER})(?P<sign>\s±\s)?(?P<error>(?(sign){NUMBER}))(?P<unit>(?:\s?[^\W\d]+|\s?%)?)"
    r"<!-- (?P<record>[\w-]+)/(?P<name>[^\s]+) -->"
)
COMMENT = re.compile(r"<!-- [\w-]+/[^\s]+ -->")


@dataclass(frozen=True)
class Quote:
    """A figure as it stands in a page, and as its record has it."""

    page: Path
    record: str
    name: str
    text: str
    recorded: str

    @property
    def agrees(self) -> bool:
        """Whether the page has the record's number."""
        return self.text == self.recorded

    def __str__(self) -> str:
        page = self.page.relative_to(ROOT)
        return f"{page}: {self.record}/{self.name}: the text has {self.text}, the record {self.recorded}"


def load(record: str) -> dict[str, float]:
    """Return the figures of a record; none where it has not been written yet."""
    path = RESULTS / f"{record}.json"
    return json.loads(path.read_text(encoding="utf-8"))["figures"] if path.exists() else {}


def quotes(page: Path, text: str) -> Iterator[Quote]:
    """Find every quoted figure of a page."""
    for match in QUOTE.finditer(text):
        yield _quote(page, match)


def _quote(page: Path, match: re.Match[str]) -> Quote:
    figures, name = load(match["record"]), match["name"]
    recorded = formatted(figures.get(name), match["value"])
    text = match["value"]
    if match["error"]:
        text += f" ± {match['error']}"
        recorded += f" ± {formatted(figures.get(f'{name}_err'), match['error'])}"
    return Quote(page, match["record"], name, text, recorded)


def formatted(value: float | None, like: str) -> str:
    """Write a number with the decimals, the sign and the exponent that a text has; question marks for none."""
    mantissa, _, exponent = like.partition("e")
    if value is None:
        return re.sub(r"\d", "?", mantissa).lstrip("+-−") + (f"e{exponent}" if exponent else "")
    decimals = len(mantissa.partition(".")[2])
    scaled = value / 10.0 ** int(exponent or 0)
    written = f"{abs(scaled):.{decimals}f}"
    is_zero = not re.search(r"[1-9]", written)
    plus = "+" if like.startswith("+") else ""
    sign = "−" if scaled < 0 and not is_zero else plus
    return sign + written + (f"e{exponent}" if exponent else "")


def unread_comments(text: str) -> list[str]:
    """List comments that look like a figure's and follow no number."""
    read = {match.end() for match in QUOTE.finditer(text)}
    return [match[0] for match in COMMENT.finditer(text) if match.end() not in read]


def rewritten(page: Path, text: str) -> str:
    """Put the records' numbers into a page."""

    def replace(match: re.Match[str]) -> str:
        value, _, error = _quote(page, match).recorded.partition(" ± ")
        ending = match[0][match.end("error") - match.start() :]
        return value + (match["sign"] or "") + error + ending

    return QUOTE.sub(replace, text)


def main() -> None:
    """Compare or rewrite the pages."""
    is_writing = "--write" in sys.argv[1:]
    differences = []
    for page in PAGES:
        text = page.read_text(encoding="utf-8")
        differences += [quote for quote in quotes(page, text) if not quote.agrees]
        if is_writing:
            page.write_text(rewritten(page, text), encoding="utf-8")
    print("\n".join(map(str, differences)) or "every figure is that of its record")
    sys.exit(1 if differences and not is_writing else 0)


if __name__ == "__main__":
    main()
