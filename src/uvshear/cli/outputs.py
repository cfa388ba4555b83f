"""Reservation of the outputs of a command until it ends."""
# ruff: noqa: PLC0415  (help must not wait for imports)

from collections.abc import Sequence
from pathlib import Path

import typer


def reserve(context: typer.Context, outputs: Sequence[Path], inputs: Sequence[Path] = ()) -> None:
    """Reserve outputs; refuse them if they are inputs, are given twice, or are reserved by another process.

    Parameters
    ----------
    context
        Context of the command, at whose end the outputs are released.
    outputs
        Files and directories that the command writes, each of which can be written.
    inputs
        Files and directories that it reads.
    """
    from uvshear.io.outputs import check_apart
    from uvshear.io.reservations import reserved

    check_apart(outputs, inputs)
    context.with_resource(reserved(outputs))
