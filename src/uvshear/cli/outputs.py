"""Outputs of a command, which belong to it until it ends."""
# ruff: noqa: PLC0415  (help must not wait for imports)

from collections.abc import Sequence
from pathlib import Path

import typer


def reserve(context: typer.Context, outputs: Sequence[Path], inputs: Sequence[Path] = ()) -> None:
    """Refuse outputs that are inputs, or one another, or at work in another process, and reserve the others.

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
