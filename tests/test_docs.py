"""What README and the pages say is what the records of the benchmarks have, and their links lead somewhere."""

import json
import re
from pathlib import Path

import numpy as np
import pytest
from astropy.table import Table
from benchmarks import quotes

from uvshear.estimators import UnlensedPopulation
from uvshear.io.catalogue import catalogue_from_table
from uvshear.io.population import read_population
from uvshear.io.shapes import COLUMNS

ROOT = Path(__file__).parents[1]
PAGES = (*quotes.PAGES, ROOT / "CONTRIBUTING.md", ROOT / "CHANGELOG.md")
RECORDS = sorted(quotes.RESULTS.glob("*.json"))
PROVENANCE = {"title", "command", "commit", "version", "date", "machine", "seeds", "figures"}

NO_FIGURES = ("3.11", "0.1.0", "0.2.0", "0.07", "4.1", "4.2")
"""Numbers of README that nobody measured: versions, a weight that is defined, sections of the paper."""


def _name(path: Path) -> str:
    return path.name


@pytest.mark.parametrize("page", quotes.PAGES, ids=_name)
def test_every_quoted_figure_is_that_of_its_record(page):
    text = page.read_text(encoding="utf-8")
    assert [str(quote) for quote in quotes.quotes(page, text) if not quote.agrees] == []
    assert quotes.unread_comments(text) == []


def test_no_figure_of_the_readme_is_awaited():
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    awaited = [quote for quote in quotes.quotes(ROOT, text) if "?" in quote.text]
    assert [f"{quote.record}/{quote.name}" for quote in awaited] == []


def test_every_measured_number_of_the_readme_names_its_record():
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    text = re.sub(r"```.*?```", "", text, flags=re.S)
    text = re.sub(r"^    .*$|`[^`]*`|\]\([^)]*\)", "", text, flags=re.M)
    unquoted = quotes.QUOTE.sub("", text)
    decimals = [number for number in re.findall(r"\d+\.\d+", unquoted) if number not in NO_FIGURES]
    assert decimals == []
    results = unquoted.partition("## Results")[2]
    assert re.findall(r"\d+ ?(?:%|min|s|h|GB)\b", results) == ["8 h"]  # of the observation


@pytest.mark.parametrize("path", RECORDS, ids=_name)
def test_a_record_says_where_its_figures_come_from(path):
    record = json.loads(path.read_text(encoding="utf-8"))
    if path.stem == "paper":
        assert record["source"]
    else:
        assert set(record) >= PROVENANCE
        assert record["command"]
        assert record["commit"]
        assert record["seeds"]
    figures = record["figures"]
    assert all(np.isfinite(value) for value in figures.values())
    errors = {name for name in figures if name.endswith("_err")}
    assert {name.removesuffix("_err") for name in errors} <= set(figures)


def test_every_record_is_quoted():
    text = "".join(page.read_text(encoding="utf-8") for page in quotes.PAGES)
    named = {match["record"] for match in quotes.QUOTE.finditer(text)}
    assert {path.stem for path in RECORDS} - named == set()


def test_a_figure_that_differs_in_its_last_digit_is_found(monkeypatch):
    monkeypatch.setattr(quotes, "load", lambda _: {"slope": 0.99512, "slope_err": 0.0022})
    (right,) = quotes.quotes(ROOT / "page.md", "is 0.995 ± 0.002<!-- run/slope -->.")
    (wrong,) = quotes.quotes(ROOT / "page.md", "is 0.994 ± 0.002<!-- run/slope -->.")
    (rough,) = quotes.quotes(ROOT / "page.md", "is 1.00<!-- run/slope -->.")
    assert (right.agrees, wrong.agrees, rough.agrees) == (True, False, True)


@pytest.mark.parametrize(
    ("text", "value", "written"),
    [
        ("0.12", -0.004, "0.00"),
        ("−0.12", 0.0149, "0.01"),
        ("+0.1", 0.26, "+0.3"),
        ("12 %", 7.4, "7 %"),
        ("3e-5", 4.4e-5, "4e-5"),
        ("?.??", 0.874, "0.87"),
        ("1.0 ±\n0.1 s", 0.874, "0.9 ±\n0.2 s"),
    ],
)
def test_a_number_is_written_as_the_text_has_it(text, value, written, monkeypatch):
    monkeypatch.setattr(quotes, "load", lambda _: {"figure": value, "figure_err": 0.2})
    page = quotes.rewritten(ROOT / "page.md", f"{text}<!-- run/figure -->")
    assert page == f"{written}<!-- run/figure -->"


@pytest.mark.parametrize("page", PAGES, ids=_name)
def test_links_between_pages_lead_somewhere(page):
    targets = re.findall(r"\]\((?!https?:)([^)#]+)", page.read_text(encoding="utf-8"))
    assert [target for target in targets if not (page.parent / target).exists()] == []


@pytest.mark.parametrize("page", PAGES, ids=_name)
def test_modules_and_scripts_that_a_page_names_exist(page):
    """Paths in code spans: `benchmarks/crowded.py`, `shapes/moments.py` of the package."""
    text = page.read_text(encoding="utf-8").partition("## 0.1.0")[0]
    named = re.findall(r"`(?:python )?((?:[\w-]+/)+[\w-]+\.py)\b", text)
    places = (ROOT, ROOT / "src" / "uvshear")
    assert [name for name in named if not any((place / name).exists() for place in places)] == []


def test_the_page_of_files_lists_every_column_of_a_table_of_shapes():
    text = (ROOT / "docs" / "files.md").read_text(encoding="utf-8")
    rows = [
        f"| `{name}` | {(column.unit or '').replace('uJy', 'μJy')} | {column.description} |"
        for name, column in COLUMNS.items()
    ]
    assert "\n".join(rows) in text


def test_the_page_of_files_shows_the_population_of_the_paper(tmp_path):
    text = (ROOT / "docs" / "files.md").read_text(encoding="utf-8")
    (shown,) = re.findall(r"```json\n(.*?)```", text, flags=re.S)
    path = tmp_path / "population.json"
    path.write_text(shown)
    assert read_population(path) == UnlensedPopulation()


def test_the_page_of_files_lists_every_column_of_a_catalogue():
    """A catalogue that has all of its optional quantities is written with all of these columns."""
    text = (ROOT / "docs" / "files.md").read_text(encoding="utf-8")
    catalogues = text.partition("## Catalogues")[2].partition("## Shapes")[0]
    listed = {
        name
        for row in re.findall(r"^\| (`.*?) \|", catalogues, flags=re.M)
        for name in re.findall(r"`(\w+)`", row)
    }
    numbers = dict.fromkeys(listed, 0.1) | {"reference_frequency": 1e9}
    words = {"id": "a", "profile": "galaxy"}
    table = Table({name: [words.get(name, numbers[name])] for name in listed})
    table["flux"].unit = "Jy"
    for name in ("ra_err", "dec_err", "flux_err"):
        assert name in listed
    known = catalogue_from_table(table)
    assert known.shear is not None
    assert known.ellipticity is not None
    assert known.position_err is not None
    assert known.flux_err is not None
    assert known.scale_length is not None
    assert known.is_point is not None
    assert known.reference_frequency == 1e9
