"""Compressed files."""

import bz2
import gzip
import lzma

import pytest

from uvshear.errors import InputError
from uvshear.io import decompression
from uvshear.io.decompression import decompressed

WRITERS = {"gz": gzip.compress, "bz2": bz2.compress, "xz": lzma.compress}


@pytest.mark.parametrize("kind", WRITERS)
def test_the_content_is_returned_whatever_the_name(tmp_path, kind):
    path = tmp_path / "table"
    path.write_bytes(WRITERS[kind](b"ra,dec\n1,2\n"))
    assert decompressed(path) == b"ra,dec\n1,2\n"


def test_a_plain_file_is_left_alone(tmp_path):
    path = tmp_path / "table.gz"
    path.write_bytes(b"ra,dec\n1,2\n")
    assert decompressed(path) is None


@pytest.mark.parametrize("kind", WRITERS)
def test_a_file_that_explodes_is_refused(tmp_path, kind):
    """100 MB of zeros are 100 kB of gzip; no more than 65 MB of them are unpacked."""
    path = tmp_path / "bomb"
    path.write_bytes(WRITERS[kind](bytes(100_000_000)))
    assert path.stat().st_size < 200_000
    with pytest.raises(
        InputError, match=r"bomb: holds more than 64 MB in .* MB of .*decompress it first"
    ):
        decompressed(path)


def test_unpacking_ends_at_the_limit(tmp_path, monkeypatch):
    path = tmp_path / "bomb"
    path.write_bytes(gzip.compress(bytes(1_000_000_000), 1))
    read = []

    class Counted(gzip.GzipFile):
        def read(self, size=-1):
            block = super().read(size)
            read.append(len(block))
            return block

    monkeypatch.setitem(decompression._OPENERS, b"\x1f\x8b", ("gzip", Counted))
    with pytest.raises(InputError, match="holds more than"):
        decompressed(path)
    assert sum(read) <= max(decompression.ALWAYS, 100 * path.stat().st_size) + (1 << 20)


def test_a_large_table_of_usual_compression_is_read(tmp_path):
    rows = b"".join(
        b"%.6f,%.6f,%d\n" % (k * 1.234567 % 360, k * 7.654321 % 90, k) for k in range(10000)
    )
    path = tmp_path / "table.gz"
    path.write_bytes(gzip.compress(rows * 300))
    content = decompressed(path)
    assert content is not None
    assert len(content) > decompression.ALWAYS


@pytest.mark.parametrize("kind", WRITERS)
@pytest.mark.parametrize("damage", ["cut", "flipped"])
def test_damaged_data_are_refused_in_a_line(tmp_path, kind, damage):
    content = bytearray(WRITERS[kind](bytes(range(256)) * 40))
    if damage == "cut":
        content = content[: len(content) // 2]
    else:
        content[len(content) // 2] ^= 0xFF
    path = tmp_path / "table"
    path.write_bytes(content)
    with pytest.raises(InputError, match="cannot be decompressed") as caught:
        decompressed(path)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("start", [b"PK\x03\x04", b"\x89HDF\r\n", b"PAR1", b"\x28\xb5\x2f\xfd"])
def test_other_containers_are_named(tmp_path, start):
    path = tmp_path / "table"
    path.write_bytes(start + bytes(100))
    with pytest.raises(InputError, match="unpack it or convert it"):
        decompressed(path)
