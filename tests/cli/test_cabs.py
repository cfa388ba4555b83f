"""The cabs for stimela name options that the commands have."""

from pathlib import Path

import pytest
import typer
import yaml

from uvshear.cli.application import app

CABS = yaml.safe_load(
    (Path(__file__).parents[2] / "stimela" / "uvshear.yml").read_text(encoding="utf-8")
)["cabs"]


@pytest.mark.parametrize("name", CABS)
def test_every_input_of_a_cab_is_an_option(name: str) -> None:
    cab = CABS[name]
    program, command = cab["command"].split()
    assert program == "uvshear"
    known = {
        word
        for parameter in typer.main.get_command(app).commands[command].params
        for word in parameter.opts
    }
    for kind in ("inputs", "outputs"):
        for option, schema in cab[kind].items():
            if not schema.get("policies", {}).get("positional"):
                word = schema.get("nom_de_guerre", option).replace("_", "-")
                assert f"--{word}" in known


@pytest.mark.parametrize("name", CABS)
def test_every_choice_of_a_cab_is_one_of_the_command(name: str) -> None:
    cab = CABS[name]
    parameters = typer.main.get_command(app).commands[cab["command"].split()[1]].params
    by_word = {word: one for one in parameters for word in one.opts}
    for option, schema in cab["inputs"].items():
        if "choices" in schema:
            known = type(by_word[f"--{option.replace('_', '-')}"].default)
            assert {str(choice) for choice in known} == set(schema["choices"])
