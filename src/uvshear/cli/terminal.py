"""Output for the user: lines, tables and notes."""
# ruff: noqa: PLC0415  (help must not wait for imports)

import sys
import warnings
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import Any

import typer

from uvshear.cli.standard_streams import StandardStream


def show_table(title: str, columns: Sequence[str], rows: Sequence[Sequence[str]]) -> None:
    """Show a table on stdout, aligned and without colours or frames when it is no terminal."""
    from rich import box
    from rich.console import Console
    from rich.table import Table

    width = None if sys.stdout.isatty() else 200
    console = Console(width=width, highlight=False, markup=False)
    table = Table(title=title, title_justify="left", box=box.SIMPLE_HEAD)
    for index, column in enumerate(columns):
        table.add_column(column, justify="left" if index == 0 else "right")
    for row in rows:
        table.add_row(*row)
    console.print(table)


def show_facts(title: str, facts: Sequence[tuple[str, str]]) -> None:
    """Show pairs of a name and a value on stdout, one pair a line."""
    width = max(len(name) for name, _ in facts)
    show("\n".join([title, *(f"  {name:<{width}}  {fact}" for name, fact in facts)]))


@contextmanager
def notes_of_warnings() -> Iterator[None]:
    """Show warnings about the data as notes on stderr, each time that they are issued."""
    from uvshear.errors import DataWarning

    with warnings.catch_warnings():
        warnings.simplefilter("always", DataWarning)
        shown = warnings.showwarning

        def show(message: Warning | str, category: type[Warning], *where: Any, **more: Any) -> None:
            if issubclass(category, DataWarning):
                warn(str(message))
            else:
                shown(message, category, *where, **more)

        warnings.showwarning = show
        yield


@contextmanager
def remarks() -> Iterator[None]:
    """Let nothing that goes wrong within the block, which only says something about a result, end the run."""
    try:
        yield
    except Exception as error:
        warn(f"a remark cannot be shown ({type(error).__name__}: {' '.join(str(error).split())})")


def warn(text: str) -> None:
    """Show a note on stderr about a run that goes on."""
    typer.echo(f"uvshear: note: {text}", err=True)


def show(text: str) -> None:
    """Show a result on stdout, without which the command has failed."""
    typer.echo(text)


def say(text: str) -> None:
    """Show a line on stdout about results that are in files."""
    output = sys.stdout
    if isinstance(output, StandardStream):
        output.remark(f"{text}\n")
    else:
        typer.echo(text)


def shorten(name: str, longest: int = 32) -> str:
    """Shorten a name that does not fit over a picture."""
    return name if len(name) <= longest else f"{name[: longest - 1]}…"
