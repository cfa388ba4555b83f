import json
import math
from contextlib import AbstractContextManager
from pathlib import Path

import pytest

from uvshear.errors import InputError
from uvshear.io.outputs import (
    check_output,
    new_file,
    remove_unfinished,
    unfinished,
    write_json,
)


def _begin_and_stop(
    output: AbstractContextManager[Path], interruption: type[BaseException]
) -> None:
    with output as temporary:
        temporary.write_text("half")
        raise interruption


def test_a_file_appears_under_its_name_with_nothing_beside_it(tmp_path: Path) -> None:
    with new_file(tmp_path / "out.fits") as temporary:
        assert temporary.suffix == ".fits"
        assert not (tmp_path / "out.fits").exists()
        temporary.write_text("whole")
    assert [p.name for p in tmp_path.iterdir()] == ["out.fits"]
    assert (tmp_path / "out.fits").read_text() == "whole"


@pytest.mark.parametrize("interruption", [KeyboardInterrupt, ValueError])
def test_an_interrupted_file_leaves_nothing(
    tmp_path: Path, interruption: type[BaseException]
) -> None:
    with pytest.raises(interruption):
        _begin_and_stop(new_file(tmp_path / "out.ecsv"), interruption)
    assert list(tmp_path.iterdir()) == []


def test_an_interrupted_overwrite_keeps_the_old_file(tmp_path: Path) -> None:
    path = tmp_path / "out.ecsv"
    path.write_text("old")
    with pytest.raises(KeyboardInterrupt):
        _begin_and_stop(new_file(path, overwrite=True), KeyboardInterrupt)
    assert path.read_text() == "old"
    assert len(list(tmp_path.iterdir())) == 1


def test_an_existing_file_is_kept_unless_overwriting_is_asked_for(tmp_path: Path) -> None:
    path = tmp_path / "out.json"
    write_json(path, {"n": 1})
    with pytest.raises(InputError, match=r"out\.json: exists already; give --overwrite"):
        write_json(path, {"n": 2})
    write_json(path, {"n": 3}, overwrite=True)
    assert json.loads(path.read_text()) == {"n": 3}


def test_a_missing_directory_is_named(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"nowhere does not exist"):
        check_output(tmp_path / "nowhere" / "out.json", overwrite=True)


def test_a_file_in_place_of_the_directory_is_named(tmp_path: Path) -> None:
    (tmp_path / "plain").write_text("")
    with pytest.raises(InputError, match=r"plain is not a directory"):
        check_output(tmp_path / "plain" / "out.json", overwrite=True)


def test_an_unwritable_directory_is_an_input_error() -> None:
    # /proc refuses new files to everyone, root included
    with pytest.raises(InputError, match=r"/proc/out\.json"), new_file(Path("/proc/out.json")):
        pass


def test_a_directory_is_never_replaced_by_a_file(tmp_path: Path) -> None:
    keep = tmp_path / "photos"
    keep.mkdir()
    with pytest.raises(InputError, match="is a directory"), new_file(keep, overwrite=True):
        pass
    assert keep.is_dir()


def test_json_holds_no_nan(tmp_path: Path) -> None:
    write_json(tmp_path / "out.json", {"g1": math.nan, "n": 4, "estimator": "mean"})
    assert json.loads((tmp_path / "out.json").read_text()) == {
        "g1": None,
        "n": 4,
        "estimator": "mean",
    }


def test_what_is_being_written_does_not_outlive_an_abandoned_process(tmp_path: Path) -> None:
    directory = tmp_path / ".field.ms.partial"
    directory.mkdir()
    with unfinished(directory), new_file(tmp_path / "out.fits") as temporary:
        temporary.write_text("half")
        remove_unfinished()
        assert list(tmp_path.iterdir()) == []
        temporary.write_text("whole")
    assert [path.name for path in tmp_path.iterdir()] == ["out.fits"]
