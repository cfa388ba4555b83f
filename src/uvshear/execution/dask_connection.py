"""The connection to the scheduler of a Dask cluster, which is checked before any work starts."""

import logging
import re
import threading
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from typing import Any, Final

from uvshear.errors import InputError
from uvshear.execution.dask_worker import check_version, version
from uvshear.execution.parcel import Parcel

ANSWERS_WITHIN: Final = 5.0
"""Time within which the scheduler and the workers must answer [s]."""

_ADDRESS: Final = re.compile(r"((tcp|tls)://)?([\w.-]+|\[[\da-fA-F:.]+\]):\d{1,5}/?")


@contextmanager
def connected(address: str) -> Iterator[Any]:
    """Yield a ``distributed.Client`` of the scheduler at an address; it is closed at the end, with all of its tasks.

    Raises
    ------
    InputError
        Dask is not installed, nobody answers, or the cluster cannot do the work.
    """
    if not _ADDRESS.fullmatch(address):
        raise InputError(
            f"--scheduler {address}: not an address; HOST:PORT or PROTOCOL://HOST:PORT is needed, for example"
            " tcp://10.0.0.1:8786"
        )
    try:
        from distributed import Client  # noqa: PLC0415 - Dask is optional, and nobody else waits for it
    except ImportError:
        raise InputError(
            "--scheduler: Dask is not installed; install it with pip install 'uvshear[dask]'"
        ) from None
    with _without_log():
        client = _answering(Client, address)
        try:
            _check(client, address)
            yield client
        finally:
            client.close(timeout=ANSWERS_WITHIN)


def _answering(client: Callable[..., Any], address: str) -> Any:
    """Return the client, if it connects in time: where another service listens, it would wait for ever."""
    found: list[Any] = []

    def connect() -> None:
        # Whatever goes wrong, nobody answers.
        with warnings.catch_warnings(), suppress(Exception):
            # Versions of other packages differ on many clusters; that of this package is checked.
            warnings.simplefilter("ignore")
            options = {"set_as_default": False, "direct_to_workers": True, "name": "uvshear"}
            found.append(client(address, timeout=ANSWERS_WITHIN, **options))

    attempt = threading.Thread(target=connect, daemon=True)
    attempt.start()
    attempt.join(2 * ANSWERS_WITHIN)
    if not found:
        raise InputError(
            f"--scheduler {address}: no Dask scheduler has answered at this address within"
            f" {2 * ANSWERS_WITHIN:g} s"
        )
    return found[0]


def _check(client: Any, address: str) -> None:
    """Refuse a cluster without workers, with other versions of the package, or with workers out of reach."""
    count = len(client.nthreads())
    if count == 0:
        raise InputError(
            f"--scheduler {address}: the cluster has no workers; start some with dask worker {address}"
        )
    found = client.run(version, on_error="return")
    for answer in found.values():
        if "ModuleNotFoundError" in str(answer):
            raise InputError(
                f"--scheduler {address}: uvshear is not installed on the workers ({answer})"
            )
        if isinstance(answer, Exception):
            raise InputError(f"--scheduler {address}: a worker does not answer ({answer})")
        check_version(answer, version())
    try:
        (held,) = client.scatter(
            [Parcel.packed(None)], direct=True, broadcast=True, hash=False, timeout=ANSWERS_WITHIN
        )
        client.gather(held, direct=True)
    except Exception as error:
        raise InputError(
            f"--scheduler {address}: its workers cannot be reached from this machine, which sends them data directly;"
            " start the command in the network of the cluster"
        ) from error


@contextmanager
def _without_log() -> Iterator[None]:
    """Silence the logs of Dask within the block: what matters becomes an error of one line."""
    names = [
        name for name in logging.root.manager.loggerDict if name.split(".")[0] == "distributed"
    ]
    logs = {name: logging.getLogger(name) for name in names}
    before = {name: log.disabled for name, log in logs.items()}
    for log in logs.values():
        log.disabled = True
    try:
        yield
    finally:
        for name, log in logs.items():
            log.disabled = before[name]
