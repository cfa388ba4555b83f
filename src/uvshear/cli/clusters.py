"""The option that names the cluster of a command."""
# ruff: noqa: PLC0415  (help must not wait for imports)

from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Annotated

import typer

from uvshear.cli.panels import RESOURCES

if TYPE_CHECKING:
    from uvshear.execution import Executor

SchedulerOption = Annotated[
    str | None,
    typer.Option(
        "--scheduler",
        metavar="ADDRESS",
        rich_help_panel=RESOURCES,
        help="Address of the scheduler of a Dask cluster whose workers share the work with this machine, for example"
        " tcp://10.0.0.1:8786 (docs/cluster.md). Results do not depend on the cluster. This option needs Dask (pip"
        " install 'uvshear[dask]').",
        show_default=False,
    ),
]


def executor_of(context: typer.Context, scheduler: str | None, local: "Executor") -> "Executor":
    """Return the executor of this machine, or of the cluster to which the command stays connected until it ends."""
    if scheduler is None:
        return local
    return context.with_resource(_on_cluster(scheduler, local))


@contextmanager
def _on_cluster(scheduler: str, local: "Executor") -> Iterator["Executor"]:
    from uvshear.execution import Dask, connected

    with connected(scheduler) as client:
        yield Dask(client, local)
