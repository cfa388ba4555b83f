"""The origin of a file."""

import json
from datetime import UTC, datetime, timedelta
from pathlib import Path

from uvshear import __version__
from uvshear.io.provenance import Provenance, ascii_text

MADE = Provenance(
    "uvshear measure α.ms", ("α.ms", "cat.fits"), {"uv_min": 1000.0, "out": Path("o")}
)


def test_metadata_are_short_keys_and_ascii() -> None:
    found = MADE.metadata()
    assert set(found) == set(Provenance.KEYS)
    assert all(len(name) <= 8 and text.isascii() for name, text in found.items())
    assert found["command"] == r"uvshear measure \u03b1.ms"
    assert json.loads(found["inputs"]) == ["α.ms", "cat.fits"]
    assert json.loads(found["options"]) == {"uv_min": 1000.0, "out": "o"}
    assert found["version"].startswith("uvshear ")


def test_a_record_is_for_json() -> None:
    found = json.loads(json.dumps(MADE.record()))
    assert found["version"] == __version__
    assert found["command"] == "uvshear measure α.ms"
    assert found["inputs"] == ["α.ms", "cat.fits"]
    assert found["options"] == {"uv_min": 1000.0, "out": "o"}
    age = datetime.now(UTC) - datetime.fromisoformat(found["date"])
    assert timedelta(0) <= age < timedelta(minutes=1)


def test_text_is_json() -> None:
    assert json.loads(ascii_text({"a": [1, "β"], "b": None})) == {"a": [1, "β"], "b": None}
