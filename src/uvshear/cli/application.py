"""The command-line application: its commands, its exit statuses and its error messages of one line."""

import ctypes
import errno
import gc
import os
import signal
import sys
import threading
import time
from collections.abc import Callable, Sequence
from concurrent.futures import BrokenExecutor
from contextlib import suppress
from dataclasses import dataclass
from queue import Empty, SimpleQueue
from typing import Annotated, Final

import typer

from uvshear import __version__
from uvshear.cli import (
    average,
    bias,
    catalogue,
    demo,
    info,
    layouts,
    measure,
    psf,
    reproduce,
    shear,
    simulate,
)
from uvshear.cli.signals import EndRequest, ending_signals
from uvshear.cli.standard_streams import (
    StandardStream,
    open_closed_descriptors,
    standard_streams,
)
from uvshear.errors import InputError
from uvshear.execution import ClusterLost, start_libraries_with_one_thread
from uvshear.io.unfinished import remove_unfinished

WRONG_INPUT: Final = 2
INTERRUPTED: Final = 128 + signal.SIGINT
BROKEN_PIPE: Final = 128 + signal.SIGPIPE
INTERRUPTION: Final = "uvshear: interrupted; unfinished outputs have been removed"

GRACE: Final = 1.0
"""Time that a command has to clean up after itself once it is interrupted [s]."""

WAKE: Final = 0.2
"""Longest time between the arrival of a signal in another thread and its answer [s]."""

OBJECTS_BETWEEN_COLLECTIONS: Final = 10_000
"""Number of new containers after which Python looks for garbage in cycles. With its own number, which is 700 in Python
3.11, it would do so hundreds of times while libraries are imported."""

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
for module in (
    *(layouts, catalogue, simulate, info, average, measure, shear, bias, psf),
    *(reproduce, demo),
):
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


@dataclass(frozen=True)
class Outcome:
    """How a command ended.

    Parameters
    ----------
    status
        Exit status.
    message
        Message for standard error; empty where there is nothing to say.
    bug
        Error of the program itself, whose traceback is needed.
    """

    status: int
    message: str = ""
    bug: BaseException | None = None


def main(arguments: Sequence[str] | None = None) -> None:
    """Run the command line and exit.

    The exit status is 0; 2 for a wrong input, an output that cannot be written, too little memory, or workers or a
    cluster that were lost; 1, with a traceback, for an error of
    the program itself; and 128 + N if signal N ended the command. The command runs in a thread of its own, so that the
    main thread can answer signals while compiled code runs.
    """
    open_closed_descriptors()
    start_libraries_with_one_thread()
    gc.set_threshold(OBJECTS_BETWEEN_COLLECTIONS)
    events: SimpleQueue[Outcome | EndRequest] = SimpleQueue()
    with ending_signals(events.put), standard_streams() as output:
        worker = threading.Thread(target=_settle, args=(events.put, arguments, output), daemon=True)
        worker.start()
        event = _next(events)
        outcome = event if isinstance(event, Outcome) else _stop(worker, event, events)
        worker.join()
        status = _show(outcome)
    # At exit the interpreter would look through all objects several times, which takes half a second.
    gc.freeze()
    sys.exit(status)


def _next(events: "SimpleQueue[Outcome | EndRequest]") -> Outcome | EndRequest:
    """Wait for an event, and wake up now and then: a signal that another thread receives does not wake this one."""
    while True:
        with suppress(Empty):
            return events.get(timeout=WAKE)


def _settle(
    report: Callable[[Outcome], None], arguments: Sequence[str] | None, output: StandardStream
) -> None:
    try:
        report(_outcome(arguments, output))
    except KeyboardInterrupt:  # while another error was explained
        report(Outcome(INTERRUPTED, INTERRUPTION))


def run(arguments: Sequence[str] | None = None) -> int:
    """Run the command line in this thread and return the exit status."""
    with standard_streams() as output:
        return _show(_outcome(arguments, output))


def _show(outcome: Outcome) -> int:
    """Show the message of an outcome and return its status."""
    if outcome.bug is not None:
        raise outcome.bug
    if outcome.message:
        typer.echo(outcome.message, err=True)
    return outcome.status


def _stop(
    worker: threading.Thread, ending: EndRequest, events: "SimpleQueue[Outcome | EndRequest]"
) -> Outcome:
    """Interrupt the command; end the process if it does not stop within ``GRACE`` or a second signal arrives.

    A command that is importing a module is not interrupted but ended at once: an interrupted import may leave a library
    half loaded, or a lock that is never released.
    """
    event: Outcome | EndRequest = ending
    if not _is_importing(worker):
        # A thread that the command is just starting still has the identity of the command's own thread. It may get the
        # interruption instead, and Python would print a traceback.
        sys.unraisablehook = _nothing
        interrupt = ctypes.py_object(KeyboardInterrupt)
        ctypes.pythonapi.PyThreadState_SetAsyncExc(ctypes.c_ulong(worker.ident or 0), interrupt)
        with suppress(Empty):
            event = events.get(timeout=GRACE)  # another signal: the user is in a hurry
    if isinstance(event, Outcome) and event.status == 0:
        return event  # the command finished before it was interrupted
    remove_unfinished()
    stopped = Outcome(ending.status, INTERRUPTION + _what_is_left())
    # At exit the interpreter would wait for the threads of a pool, which end only when their tasks are done.
    if not isinstance(event, Outcome) or threading.active_count() > 1:
        _show(stopped)
        if not isinstance(event, Outcome):
            # If the module has not been imported, there is no log.
            getattr(sys.modules.get("uvshear.io.run_log"), "end_open_logs", _nothing)()
        # If uvshear.execution has not been imported, there are no worker processes to end.
        execution = sys.modules.get("uvshear.execution")
        for name in ("end_processes", "end_copies"):
            getattr(execution, name, _nothing)()
        os._exit(stopped.status)
    return stopped


def _what_is_left() -> str:
    """Store the state of a measurement that ends before its time, and return what is to be said about it."""
    # If the module has not been imported, nothing is measured.
    checkpoint = sys.modules.get("uvshear.io.checkpoint")
    left: list[object] = getattr(checkpoint, "checkpoints_left", list)()
    return "".join(
        f"; the state of the measurement is in {path}: run the same command with --resume to go on from it"
        for path in left
    )


def _is_importing(worker: threading.Thread) -> bool:
    """Tell whether a thread is within an import."""
    frame = sys._current_frames().get(worker.ident or 0)
    while frame is not None:
        if frame.f_code.co_filename.startswith("<frozen importlib"):
            return True
        frame = frame.f_back
    return False


def _nothing(*_: object) -> None:
    pass


def _outcome(arguments: Sequence[str] | None, output: StandardStream) -> Outcome:
    """Run the command line and return its outcome, also if it raises."""
    try:
        status = app(args=arguments, prog_name="uvshear", standalone_mode=False)
    except (KeyboardInterrupt, typer.Abort):
        status = INTERRUPTED
    except BrokenExecutor as error:
        # If all processes of a job get a signal, the workers may end first. Wait, so that the main thread can report
        # the signal instead of this error.
        time.sleep(GRACE)
        return _failure(error)
    except SystemExit as ended:  # from typer, after an error in a pipe
        return _failure(ended.__context__ if ended.__context__ is not None else ended)
    except BaseException as error:
        return _failure(error)
    if status == INTERRUPTED:
        return Outcome(INTERRUPTED, INTERRUPTION)
    if output.lost is not None:
        return _failure_of_output(output.lost)
    return Outcome(status if isinstance(status, int) else 0)


def _failure(error: BaseException) -> Outcome:
    message = _explain(error)
    if message is None:
        return Outcome(1, bug=error)
    return Outcome(WRONG_INPUT, message + _what_is_left())


def _failure_of_output(error: OSError) -> Outcome:
    """Return the outcome of a command whose result could not be printed; a broken pipe gets no message."""
    if error.errno == errno.EPIPE:
        return Outcome(BROKEN_PIPE)
    return Outcome(
        WRONG_INPUT, f"uvshear: error: standard output: cannot be written ({error.strerror})"
    )


def _explain(error: BaseException) -> str | None:
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
    elif isinstance(error, ClusterLost):
        message = str(error)
    elif isinstance(error, BrokenExecutor):
        message = (
            "a worker process ended before its work was done; it may have been killed for lack of memory, of which"
            " fewer --threads need less"
        )
    elif isinstance(error, OSError):
        message = str(error) if error.filename is None else f"{error.filename}: {error.strerror}"
    else:
        return None
    return f"uvshear: error: {' '.join(message.split())}"


def _with_the_command(error: BaseException) -> str:
    """Return the message of an error in the options, with the command that shows their help."""
    context = getattr(error, "ctx", None)
    command = "uvshear" if context is None else context.command_path
    message = error.format_message().rstrip(".")  # type: ignore[attr-defined]
    return f"{message}; see {command} --help"
