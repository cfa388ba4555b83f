"""Groups of options in the help of long commands."""

from typing import Any, Final

from typer.core import TyperCommand

DATA: Final = "Data"
SKY: Final = "Simulated sky"
ARRAY: Final = "Array and track"
NOISE: Final = "Noise"
MODEL: Final = "Model"
METHOD: Final = "Method"
OUTPUT: Final = "Output"
RESOURCES: Final = "Resources"

_ARGUMENTS: Final = "Arguments"
_OTHERS: Final = "Options"

ORDER: Final = (_ARGUMENTS, DATA, SKY, ARRAY, NOISE, MODEL, METHOD, OUTPUT, RESOURCES, _OTHERS)
"""Groups in the order of the help, the same for all commands."""


class GroupedCommand(TyperCommand):
    """A command whose help shows its options group by group."""

    def format_options(self, ctx: Any, formatter: Any) -> None:
        """Write arguments, then the options of each group."""
        groups: dict[str, list[tuple[str, str]]] = {name: [] for name in ORDER}
        for parameter in self.get_params(ctx):
            if (record := parameter.get_help_record(ctx)) is not None:
                groups[_group_of(parameter)].append(record)
        for name, records in groups.items():
            if records:
                with formatter.section(name):
                    formatter.write_dl(records)


def _group_of(parameter: Any) -> str:
    if parameter.param_type_name == "argument":
        return _ARGUMENTS
    return getattr(parameter, "rich_help_panel", None) or _OTHERS
