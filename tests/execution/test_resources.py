"""What a computation may use."""

import pytest

from uvshear.errors import InputError
from uvshear.execution import Resources, Serial, available_cores
from uvshear.execution.resources import half_of_memory


def test_all_cores_and_half_of_the_memory_are_used_unless_told() -> None:
    resources = Resources()
    assert resources.executor.workers == available_cores()
    assert resources.memory == half_of_memory() > 1e8


@pytest.mark.parametrize("memory", [0.0, -1.0, float("nan")])
def test_memory_is_positive(memory: float) -> None:
    with pytest.raises(InputError, match="memory of"):
        Resources(Serial(), memory)
