from pathlib import Path

import pytest

from uvshear.errors import InputError
from uvshear.plot.figure import check_picture, new_figure, save


def test_panels_stand_side_by_side() -> None:
    figure, axes = new_figure(3, 9.0, 3.0)
    assert len(axes) == len(figure.axes) == 3
    assert figure.get_size_inches().tolist() == [9.0, 3.0]


def test_the_extension_decides_the_format(tmp_path: Path) -> None:
    for extension, start in ((".png", b"\x89PNG"), (".PDF", b"%PDF"), (".svg", b"<?xml")):
        path = tmp_path / f"picture{extension}"
        save(new_figure(1, 2.0, 2.0)[0], path)
        assert path.read_bytes().startswith(start)


def test_a_picture_is_not_overwritten_unasked(tmp_path: Path) -> None:
    path = tmp_path / "picture.png"
    path.write_text("kept")
    with pytest.raises(InputError, match="exists already"):
        save(new_figure(1, 2.0, 2.0)[0], path)
    assert path.read_text() == "kept"
    save(new_figure(1, 2.0, 2.0)[0], path, overwrite=True)
    assert path.read_bytes().startswith(b"\x89PNG")


def test_an_unknown_kind_of_picture_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"picture\.docx"):
        save(new_figure(1, 2.0, 2.0)[0], tmp_path / "picture.docx")
    assert list(tmp_path.iterdir()) == []
    with pytest.raises(InputError, match=r"picture\.docx: the extension is not that of a picture"):
        check_picture(tmp_path / "picture.docx")
    check_picture(tmp_path / "picture.PDF")


def test_a_picture_without_a_place_is_refused_before_it_is_drawn(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="does not exist"):
        check_picture(tmp_path / "absent" / "picture.png")
