import json
import math
from contextlib import AbstractContextManager
from pathlib import Path

import pytest

from uvshear.errors import InputError
from uvshear.io.outputs import (
    check_apart,
    check_file,
    check_output,
    new_file,
    new_outputs,
    write_json,
)
from uvshear.io.unfinished import remove_unfinished


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
    with pytest.raises(InputError, match=r"out\.fits: cannot be written"):
        _abandon(tmp_path / "out.fits")
    assert list(tmp_path.iterdir()) == []


def _abandon(path: Path) -> None:
    with new_file(path) as temporary:
        temporary.write_text("half")
        remove_unfinished()
        assert list(path.parent.iterdir()) == []
        temporary.write_text("whole")


def test_the_message_names_the_output_and_not_a_temporary_file(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"out\.json: cannot be written: Is a directory") as caught:
        _write_onto_a_directory(tmp_path / "out.json")
    assert ".uvshear" not in str(caught.value)


def _write_onto_a_directory(path: Path) -> None:
    with new_file(path) as temporary:
        temporary.mkdir()
        write_json(temporary, {})


def test_a_file_that_appears_meanwhile_is_not_replaced_and_nothing_is_lost(tmp_path: Path) -> None:
    path = tmp_path / "out.json"
    with pytest.raises(InputError, match="exists now, although it did not when this run began"):
        _write_while_another_does(path)
    assert path.read_text() == "theirs"
    (kept,) = tmp_path.glob("out.json.kept-*")
    assert [(file.name, file.read_text()) for file in kept.iterdir()] == [("out.json", "ours")]


def _write_while_another_does(path: Path) -> None:
    with new_file(path) as temporary:
        temporary.write_text("ours")
        path.write_text("theirs")


def test_several_outputs_get_their_names_together_or_not_at_all(tmp_path: Path) -> None:
    (tmp_path / "b").write_text("old")
    with pytest.raises(InputError, match="exists now"):
        _write_two(tmp_path, overwrite=False)
    assert (tmp_path / "b").read_text() == "old"
    assert not (tmp_path / "a").exists()
    (kept,) = tmp_path.glob("b.kept-*")
    assert {file.name for file in kept.iterdir()} == {"a", "b"}
    _write_two(tmp_path, overwrite=True)
    assert {(tmp_path / name).read_text() for name in "ab"} == {"new"}


def _write_two(directory: Path, *, overwrite: bool) -> None:
    with new_outputs(directory / "a") as outputs:
        for name in "ab":
            outputs.new(directory / name, overwrite=overwrite).write_text("new")


def test_a_link_is_replaced_and_not_followed(tmp_path: Path) -> None:
    (tmp_path / "precious").write_text("old")
    (tmp_path / "out.json").symlink_to("precious")
    write_json(tmp_path / "out.json", {}, overwrite=True)
    assert (tmp_path / "precious").read_text() == "old"
    assert not (tmp_path / "out.json").is_symlink()


def test_a_device_is_never_replaced() -> None:
    with pytest.raises(InputError, match="is not an ordinary file"):
        check_file(Path("/dev/null"), overwrite=True)


def test_a_name_as_long_as_the_file_system_allows_can_be_written(tmp_path: Path) -> None:
    path = tmp_path / ("x" * 250 + ".json")
    write_json(path, {})
    assert [file.name for file in tmp_path.iterdir()] == [path.name]


@pytest.mark.parametrize(
    ("output", "message"),
    [
        ("field.ms/shapes.fits", r"is within the input .*field\.ms"),
        ("field.ms", "is an input too"),
        ("sub/../field.ms", "is an input too"),
        ("link", "is an input too"),
        ("holder", r"contains the input .*cat\.fits"),
        ("twice", "would be written twice"),
        ("sub/../twice", "would be written twice"),
    ],
)
def test_outputs_are_apart_from_inputs_and_from_one_another(
    tmp_path: Path, output: str, message: str
) -> None:
    for name in ("field.ms", "holder", "sub"):
        (tmp_path / name).mkdir()
    (tmp_path / "holder/cat.fits").write_text("")
    (tmp_path / "field.ms/table.dat").write_text("")
    (tmp_path / "link").symlink_to("holder/cat.fits")
    inputs = [tmp_path / "field.ms", tmp_path / "holder/cat.fits", tmp_path / "nowhere"]
    with pytest.raises(InputError, match=message):
        check_apart([tmp_path / "twice", tmp_path / output], inputs)
    check_apart([tmp_path / "field.ms.fits", tmp_path / "field.fits"], inputs)
