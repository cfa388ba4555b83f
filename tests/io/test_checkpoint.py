"""Checkpoints: what they are refused for, what they hold, and when they go."""

import os
import re
from collections.abc import Callable
from pathlib import Path

import pytest

from uvshear.errors import CheckpointWarning, InputError
from uvshear.io import checkpoint as module
from uvshear.io.checkpoint import (
    Checkpoint,
    CheckpointStore,
    checkpoint_beside,
    checkpoints_left,
    remove_checkpoint,
)

IDENTITY = {"the catalogue": "3 sources (ab)", "model.profile": "Exponential()"}
CONTENT = {"the visibilities": "100 samples (cd)"}


@pytest.fixture
def directory(tmp_path: Path) -> Path:
    return tmp_path / "shapes.checkpoint"


def _interrupted(directory: Path, work: Callable[[CheckpointStore], object]) -> None:
    """Let a measurement store its state until it is interrupted."""
    store = Checkpoint(directory, options={"--uv-min": 0.0}).opened(IDENTITY)

    def work_and_stop(*_: object) -> None:
        work(store)
        raise KeyboardInterrupt

    _fails(KeyboardInterrupt, store, work_and_stop)
    module._in_use.clear()


def _fails(error: type[BaseException], store: CheckpointStore, work: Callable[..., object]) -> None:
    with pytest.raises(error), store.in_use(CONTENT):
        work(store)


def _resumed(directory: Path, **options: object) -> CheckpointStore:
    return Checkpoint(directory, resumes=True, options={"--uv-min": 0.0, **options}).opened(
        IDENTITY
    )


def test_states_and_results_are_found_again(directory: Path) -> None:
    def work(store: CheckpointStore) -> None:
        store.save("sky", [1, 2])
        store.save("sky", [3, 4])
        store.part("release").save("sky", "released")
        found = store.part("first").results("posteriors")
        found.add(7, "seven")
        found.add(8, "eight")

    _interrupted(directory, work)
    store = _resumed(directory)
    with store.in_use(CONTENT):
        assert store.load("sky") == [3, 4]
        assert store.part("release").load("sky") == "released"
        found = store.part("first").results("posteriors")
        assert found[7] == "seven"
        assert 8 in found
        assert 9 not in found
        assert 7 not in store.results("posteriors")
        found.add(9, "nine")
    assert _resumed(directory).part("first").results("posteriors")[9] == "nine"
    store.remove()
    assert not directory.exists()
    assert os.listdir(directory.parent) == []


def test_results_are_stored_every_now_and_then(directory: Path, monkeypatch) -> None:
    store = Checkpoint(directory).opened(IDENTITY)
    with store.in_use(CONTENT):
        found = store.results("posteriors")
        found.add(1, 1.0)
        assert not list(directory.glob("posteriors*"))
        assert not store.is_due
        monkeypatch.setattr(module, "EVERY", 0.0)
        assert store.is_due
        found.add(2, 2.0)
        found.add(3, 3.0)
        assert len(list(directory.glob("posteriors*"))) == 2
        assert [
            found[key] for found in [_resumed_in(directory).results("posteriors")] for key in (1, 2)
        ] == [1.0, 2.0]
    store.remove()


def _resumed_in(directory: Path) -> CheckpointStore:
    return Checkpoint(directory, resumes=True).opened(IDENTITY)


def test_a_process_that_ends_stores_the_last_results(directory: Path) -> None:
    store = Checkpoint(directory).opened(IDENTITY)
    with store.in_use(CONTENT):
        store.results("posteriors").add(1, 1.0)
        assert checkpoints_left() == []  # there is no state yet
        assert list(directory.glob("posteriors*"))
    store.remove()
    assert checkpoints_left() == []


@pytest.mark.parametrize(
    ("options", "identity", "content", "named"),
    [
        ({"--uv-min": 200.0}, {}, {}, "--uv-min was 0.0 in the earlier run and is 200.0 now"),
        ({"--robust": 1}, {}, {}, "the earlier run did not have --robust, which is 1 now"),
        (
            {},
            {"observation 2": "there"},
            {},
            "the earlier run did not have observation 2, which is there now",
        ),
        (
            {},
            {"model.profile": "Gaussian()"},
            {},
            "model.profile was Exponential() in the earlier run",
        ),
        ({}, {}, {"the visibilities": "99 samples (ef)"}, "the visibilities was 100 samples"),
    ],
)
def test_what_differs_is_named(
    directory: Path,
    options: dict[str, object],
    identity: dict[str, str],
    content: dict[str, str],
    named: str,
) -> None:
    _interrupted(directory, lambda store: store.save("sky", 1))
    before = sorted(os.listdir(directory))
    checkpoint = Checkpoint(directory, resumes=True, options={"--uv-min": 0.0, **options})
    with (
        pytest.raises(InputError, match=re.escape(named)),
        checkpoint.opened(IDENTITY | identity).in_use(CONTENT | content),
    ):
        pass
    assert sorted(os.listdir(directory)) == before
    module._in_use.clear()


def test_a_run_that_does_not_resume_removes_the_old_checkpoint(directory: Path) -> None:
    _interrupted(directory, lambda store: store.save("sky", 1))
    store = Checkpoint(directory).opened({"the catalogue": "another"})
    assert (directory / "sky.state").exists()  # until the observation has been read
    with store.in_use(CONTENT):
        assert store.load("sky") is None
        assert not (directory / "sky.state").exists()
    store.remove()


def test_a_wrong_input_leaves_no_empty_checkpoint(directory: Path) -> None:
    store = Checkpoint(directory).opened(IDENTITY)

    def fail(store: CheckpointStore) -> None:
        raise InputError("wrong")

    def fail_late(store: CheckpointStore) -> None:
        store.save("sky", 1)
        raise InputError("the disk is full")

    _fails(InputError, store, fail)
    assert not directory.exists()
    _fails(InputError, store, fail_late)
    assert checkpoints_left() == [directory]
    _fails(InputError, store, fail)
    assert checkpoints_left() == []  # the second one has begun anew
    assert not directory.exists()


def test_a_run_with_nothing_to_resume_says_so(directory: Path) -> None:
    with pytest.warns(CheckpointWarning, match="there is no checkpoint; the measurement begins"):
        store = _resumed_in(directory)
    with store.in_use(CONTENT):
        pass
    module._in_use.clear()
    store = _resumed_in(directory)
    with (
        pytest.warns(CheckpointWarning, match="the earlier run ended too early"),
        store.in_use(CONTENT),
    ):
        pass
    store.remove()


@pytest.mark.parametrize("name", ["about.json", "sky.state", "posteriors.000000.results"])
@pytest.mark.parametrize("content", [b"", b"not what was written"])
def test_a_damaged_checkpoint_is_refused_before_the_work(
    directory: Path, name: str, content: bytes
) -> None:
    def work(store: CheckpointStore) -> None:
        store.save("sky", list(range(1000)))
        store.results("posteriors").add(1, 1.0)

    _interrupted(directory, work)
    (directory / name).write_bytes(content)
    with pytest.raises(
        InputError, match=f"{re.escape(name)}: this part of a checkpoint is damaged"
    ):
        _resumed(directory)


def test_what_is_no_checkpoint_is_not_touched(directory: Path) -> None:
    directory.mkdir()
    (directory / "thesis.txt").write_text("chapter 1")
    for resumes in (False, True):
        with pytest.raises(InputError, match="this name is needed for the checkpoint"):
            Checkpoint(directory, resumes).opened(IDENTITY)
    with pytest.raises(InputError, match="this name is needed for the checkpoint"):
        remove_checkpoint(directory)
    assert (directory / "thesis.txt").exists()


def test_a_link_is_not_followed(directory: Path, tmp_path: Path) -> None:
    """A checkpoint is pickled; one of somebody else could run any code."""
    _interrupted(tmp_path / "other", lambda store: store.save("sky", 1))
    directory.symlink_to(tmp_path / "other")
    with pytest.raises(InputError, match="this name is needed"):
        _resumed(directory)


def test_a_checkpoint_of_another_user_is_refused(directory: Path, monkeypatch) -> None:
    _interrupted(directory, lambda store: store.save("sky", 1))
    assert directory.stat().st_mode & 0o777 == 0o700
    monkeypatch.setattr(os, "geteuid", lambda: directory.stat().st_uid + 1)
    with pytest.raises(InputError, match="belongs to another user"):
        _resumed(directory)


def test_a_state_that_cannot_be_stored_does_not_end_the_measurement(directory: Path) -> None:
    store = Checkpoint(directory).opened(IDENTITY)
    with store.in_use(CONTENT):
        store.save("sky", 1)
        with pytest.warns(CheckpointWarning, match="could not be stored .*generator"):
            store.save("sky", (k for k in range(3)))
        store.save("sky", (k for k in range(3)))  # is not told twice: warnings are errors here
        assert store.load("sky") == 1
    store.remove()


def test_a_directory_that_cannot_be_made_is_an_error_in_one_line(tmp_path: Path) -> None:
    store = Checkpoint(tmp_path / "gone" / "shapes.checkpoint").opened(IDENTITY)
    with pytest.raises(InputError, match="checkpoint cannot be written"), store.in_use(CONTENT):
        pass


def test_tables_of_one_stem_do_not_share_a_checkpoint() -> None:
    assert checkpoint_beside(Path("a/s.fits")) == Path("a/s.checkpoint")
    assert checkpoint_beside(Path("a/s.ecsv")) == Path("a/s.ecsv.checkpoint")
