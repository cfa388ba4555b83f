"""The cabs for stimela name options that the commands have, and what is registered."""

import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
import typer
import yaml

from uvshear.cli.application import app
from uvshear.estimators.registry import ESTIMATORS
from uvshear.extraction.registry import EXTRACTIONS
from uvshear.galaxy.registry import PROFILES
from uvshear.interferometer.beam_registry import PRIMARY_BEAMS
from uvshear.plugins import Registry

CABS = yaml.safe_load(
    (Path(__file__).parents[2] / "stimela" / "uvshear.yml").read_text(encoding="utf-8")
)["cabs"]


def _options(cab: dict) -> list[Any]:
    program, command = cab["command"].split()
    assert program == "uvshear"
    return typer.main.get_command(app).commands[command].params


@pytest.mark.parametrize("name", CABS)
def test_every_input_of_a_cab_is_an_option(name: str) -> None:
    cab = CABS[name]
    known = {word for option in _options(cab) for word in option.opts}
    for kind in ("inputs", "outputs"):
        for option, schema in cab[kind].items():
            if not schema.get("policies", {}).get("positional"):
                word = schema.get("nom_de_guerre", option).replace("_", "-")
                assert f"--{word}" in known


@pytest.mark.parametrize("name", CABS)
def test_every_choice_of_a_cab_is_one_of_the_command(uvshear: Callable, name: str) -> None:
    cab = CABS[name]
    told = uvshear(cab["command"].split()[1], "--help").out
    for option, schema in cab["inputs"].items():
        if "choices" in schema:
            choices = r"\|".join(schema["choices"])
            assert re.search(rf"--{option.replace('_', '-')} .{choices}\W", told)


@pytest.mark.parametrize(
    ("name", "option", "registry", "besides"),
    [
        ("uvshear-shear", "estimator", ESTIMATORS, ()),
        ("uvshear-measure", "keep", ESTIMATORS, ()),
        ("uvshear-measure", "profile", PROFILES, ()),
        ("uvshear-measure", "extraction", EXTRACTIONS, ()),
        ("uvshear-measure", "primary_beam", PRIMARY_BEAMS, ("none",)),
    ],
)
def test_names_that_a_cab_lists_are_the_registered_ones(
    name: str, option: str, registry: Registry, besides: tuple[str, ...]
) -> None:
    known = {*registry.own, *besides}
    text = CABS[name]["inputs"][option]["info"]
    words = set(re.findall(r"[a-z][a-z0-9-]+", text.rpartition("commas:")[2])) - {"or"}
    # The mean needs no statistics.
    assert words == (known - {"mean"} if option == "keep" else known)
    assert "MODULE:NAME" in text
