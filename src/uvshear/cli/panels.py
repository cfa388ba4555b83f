"""Groups of options in the help of long commands."""

from collections import defaultdict
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

_OTHERS: Final = "Options"


class GroupedCommand(TyperCommand):
    """A command whose help shows its options group by group, in the order in which groups are met."""

    def format_options(self, ctx: Any, formatter: Any) -> None:
        """Write arguments, then the options of each group."""
        groups: dict[str, list[tuple[str, str]]] = defaultdict(list)
        for parameter in self.get_params(ctx):
            if (record := parameter.get_help_record(ctx)) is not None:
                groups[_group_of(parameter)].append(record)
        general = groups.pop(_OTHERS, [])
        for name, records in [*groups.items(), (_OTHERS, general)]:
            if records:
                with formatter.section(name):
                    formatter.write_dl(records)


def _group_of(parameter: Any) -> str:
    if parameter.param_type_name == "argument":
        return "Arguments"
    return getattr(parameter, "rich_help_panel", None) or _OTHERS
