"""Connections to clusters that cannot do the work."""

import socket
import subprocess
import sys
import time

import pytest

from tests.clusters import cluster
from uvshear.errors import InputError
from uvshear.execution import connected, dask_connection

EXAMPLE = "tcp://10.0.0.1:8786"


@pytest.mark.parametrize("address", ["", "here", "http://x:1", "tcp://x", "tcp://x:y", "x:1 y:2"])
def test_what_is_no_address_is_refused_at_once(address) -> None:
    with pytest.raises(InputError, match=f"not an address; .*{EXAMPLE}"), connected(address):
        pass


def test_an_address_where_nobody_answers_is_refused_within_seconds(monkeypatch) -> None:
    monkeypatch.setattr(dask_connection, "ANSWERS_WITHIN", 1.0)
    with socket.socket() as silent:
        silent.bind(("127.0.0.1", 0))
        silent.listen()
        began = time.monotonic()
        for port in (silent.getsockname()[1], 9):
            with (
                pytest.raises(InputError, match="no Dask scheduler has answered at this address"),
                connected(f"127.0.0.1:{port}"),
            ):
                pass
    assert time.monotonic() - began < 20


def test_a_cluster_without_workers_is_refused(tmp_path) -> None:
    with (
        cluster(tmp_path, workers=0) as found,
        pytest.raises(InputError, match="has no workers; start some with dask worker"),
        connected(found.address),
    ):
        pass


def test_a_cluster_with_another_version_is_refused(two_workers, monkeypatch) -> None:
    monkeypatch.setattr("uvshear.__version__", "9.0")
    with (
        pytest.raises(InputError, match=r"a worker has uvshear .*, but this machine has 9.0"),
        connected(two_workers.address),
    ):
        pass


def test_workers_without_the_package_are_refused(tmp_path) -> None:
    # Where this is set, the worker finds another package of the same name first.
    (tmp_path / "uvshear").mkdir()
    (tmp_path / "uvshear" / "__init__.py").write_text("")
    with (
        cluster(tmp_path, workers=1, PYTHONPATH=str(tmp_path)) as found,
        pytest.raises(InputError, match="uvshear is not installed on the workers"),
        connected(found.address),
    ):
        pass


def test_without_dask_the_command_that_installs_it_is_named() -> None:
    program = (
        "import sys; sys.modules['distributed'] = None\n"
        "from uvshear.execution import connected\n"
        "try:\n"
        "    with connected('127.0.0.1:8786'): pass\n"
        "except ValueError as error: print(error)\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, check=True, text=True
    )
    assert "pip install 'uvshear[dask]'" in done.stdout


def test_nothing_of_dask_is_imported_before_a_cluster_is_used() -> None:
    program = (
        "import sys, uvshear\n"
        "uvshear.Dask, uvshear.measure, uvshear.estimate_bias, uvshear.average\n"
        "assert not {'dask', 'distributed', 'tornado'} & set(sys.modules)\n"
    )
    subprocess.run([sys.executable, "-c", program], check=True)
