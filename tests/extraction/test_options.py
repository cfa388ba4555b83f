import pytest

from uvshear.errors import InputError
from uvshear.extraction import MeasurementOptions
from uvshear.extraction.options import default_extraction


def test_memory_is_half_of_the_machines_unless_told():
    with open("/proc/meminfo") as lines:
        kilobytes = int(next(line for line in lines if line.startswith("MemTotal")).split()[1])
    assert MeasurementOptions().memory == pytest.approx(512 * kilobytes, rel=0.01)
    assert MeasurementOptions(memory=1e9).memory == 1e9


@pytest.mark.parametrize("memory", [0.0, -1.0, float("nan")])
def test_no_memory_is_an_error(memory):
    with pytest.raises(InputError, match="more than 0"):
        MeasurementOptions(memory=memory)


def test_the_extraction_is_the_default_unless_told():
    assert MeasurementOptions().extraction == default_extraction()
