"""Objects on their way to other machines."""

import pickle
import sys

import numpy as np

from tests.execution import tasks as work
from uvshear.execution.parcel import Parcel


def _sent(parcel: Parcel) -> Parcel:
    """A parcel as another machine receives it, its buffers apart from the rest."""
    buffers: list[pickle.PickleBuffer] = []
    pickled = pickle.dumps(parcel, 5, buffer_callback=buffers.append)
    return pickle.loads(pickled, buffers=[bytearray(buffer.raw()) for buffer in buffers])


def test_a_parcel_arrives_as_it_was_sent() -> None:
    content = {"plane": np.asfortranarray(np.arange(6.0).reshape(2, 3)), "name": "field"}
    found = _sent(_sent(Parcel.packed(content))).content()
    assert found["name"] == "field"
    np.testing.assert_array_equal(found["plane"], content["plane"])
    assert found["plane"].flags.writeable


def test_an_object_is_pickled_once_however_often_it_is_sent_on(tmp_path) -> None:
    content = work.CountsItsPickles(tmp_path / "sent.txt")
    assert _sent(_sent(Parcel.packed(content))).content().log == content.log
    assert content.log.read_text() == "sent\n"


def test_a_parcel_is_unpacked_once() -> None:
    parcel = _sent(Parcel.packed([1, 2]))
    assert parcel.content() is parcel.content()


def test_arrays_are_not_copied_when_they_are_packed() -> None:
    values = np.zeros(1000)
    content = Parcel.packed(values).content()
    values[3] = 5.0
    assert content[3] == 5.0


def test_the_size_of_a_parcel_is_that_of_its_content() -> None:
    assert 8e6 < sys.getsizeof(Parcel.packed(np.zeros(1_000_000))) < 8.01e6


def test_a_copy_of_the_content_is_independent() -> None:
    parcel = Parcel.packed(np.zeros(10))
    parcel.copy()[:] = 1.0
    np.testing.assert_array_equal(parcel.content(), 0.0)
