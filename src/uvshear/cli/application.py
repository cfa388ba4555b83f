"""The command-line application: its commands, its exit statuses and its error messages of one line."""

import ctypes
import os
import sys
import threading
from collections.abc import Sequence
from concurrent.futures import Future
from contextlib import suppress
from typing import Annotated, Final

import typer

from uvshear import __version__
from uvshear.cli import bias, catalogue, demo, info, layouts, measure, psf, shear, simulate
from uvshear.errors import InputError
from uvshear.io.outputs import remove_unfinished

WRONG_INPUT: Final = 2
INTERRUPTED: Final = 130
INTERRUPTION: Final = "uvshear: interrupted; unfinished outputs have been removed"

GRACE: Final = 1.0
"""Time that a command has to clean up after itself once it is interrupted [s]."""

_ClickException: Final = typer.BadParameter.__mro__[2]
"""Root of the errors in options; typer carries its own copy of click in some versions."""

app = typer.Typer(
    name="uvshear",
    help="Weak-lensing galaxy shapes and shear, measured from radio visibilities.",
    epilog="Example: uvshear demo",
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
    add_completion=False,
    no_args_is_help=True,
    context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 100},
)
for module in (layouts, catalogue, simulate, info, measure, shear, bias, psf, demo):
    module.register(app)


def _show_version(wanted: bool) -> bool:
    if wanted:
        typer.echo(f"uvshear {__version__}")
        raise typer.Exit
    return wanted


@app.callback()
def _root(
    version: Annotated[
        bool,
        typer.Option(
            "--version", callback=_show_version, is_eager=True, help="Show the version and exit."
        ),
    ] = False,
) -> None:
    """Weak-lensing galaxy shapes and shear, measured from radio visibilities."""


def main(arguments: Sequence[str] | None = None) -> None:
    """Run the command line and exit with status 0, with 2 for a wrong input, or with 130 if interrupted.

    The command runs in a thread of its own, so that the main thread can answer Ctrl-C while compiled code runs.
    """
    outcome: Future[int] = Future()
    worker = threading.Thread(target=_settle, args=(outcome, arguments), daemon=True)
    worker.start()
    try:
        status = outcome.result()
    except KeyboardInterrupt:
        status = _stop(worker)
    worker.join()
    sys.exit(status)


def _settle(outcome: Future[int], arguments: Sequence[str] | None) -> None:
    try:
        outcome.set_result(run(arguments))
    except BaseException as error:
        outcome.set_exception(error)


def _stop(worker: threading.Thread) -> int:
    """Interrupt the command; if compiled code does not return soon, end the process at once."""
    interrupt = ctypes.py_object(KeyboardInterrupt)
    ctypes.pythonapi.PyThreadState_SetAsyncExc(ctypes.c_ulong(worker.ident or 0), interrupt)
    with suppress(KeyboardInterrupt):  # once more: the user is in a hurry
        worker.join(GRACE)
    if worker.is_alive():
        remove_unfinished()
        typer.echo(INTERRUPTION, err=True)
        sys.stdout.flush()
        os._exit(INTERRUPTED)
    return INTERRUPTED


def run(arguments: Sequence[str] | None = None) -> int:
    """Run the command line and return the exit status."""
    try:
        status = app(args=arguments, prog_name="uvshear", standalone_mode=False)
    except (KeyboardInterrupt, typer.Abort):
        status = INTERRUPTED
    except BrokenPipeError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        status = 1
    except Exception as error:
        if (message := _explain(error)) is None:
            raise  # a bug: its traceback is what we need
        typer.echo(message, err=True)
        status = WRONG_INPUT
    if status == INTERRUPTED:
        typer.echo(INTERRUPTION, err=True)
    return status if isinstance(status, int) else 0


def _explain(error: Exception) -> str | None:
    """Return the message for a wrong input, or None for an error of the program itself."""
    if type(error).__name__ == "NoArgsIsHelpError":
        return str(error)
    if isinstance(error, _ClickException):
        message = _with_the_command(error)
    elif isinstance(error, InputError):
        message = str(error)
    elif isinstance(error, MemoryError):
        message = (
            f"not enough memory ({error}); lower --memory-gb or --threads, or average the data or select fewer scans"
            " first"
        )
    elif isinstance(error, OSError):
        message = str(error) if error.filename is None else f"{error.filename}: {error.strerror}"
    else:
        return None
    return f"uvshear: error: {' '.join(message.split())}"


def _with_the_command(error: Exception) -> str:
    """Return the message of an error in the options, with the command that shows their help."""
    context = getattr(error, "ctx", None)
    command = "uvshear" if context is None else context.command_path
    message = error.format_message().rstrip(".")  # type: ignore[attr-defined]
    return f"{message}; see {command} --help"
