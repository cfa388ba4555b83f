import pickle
import time

from uvshear.execution import Threads
from uvshear.execution.once import KeptOnce


def _one(_):
    return 1


def test_a_value_is_worked_out_once_however_many_threads_ask():
    kept, calls = KeptOnce(2, _one), []

    def work_out():
        calls.append(1)
        time.sleep(0.01)
        return len(calls)

    found = list(Threads(4).map(lambda _: kept.value("key", work_out), range(8)))
    assert found == [1] * 8
    assert len(kept) == 1


def test_each_key_has_its_own_value():
    kept = KeptOnce(2, _one)
    assert [kept.value(key, lambda key=key: 2 * key) for key in (1, 2, 1)] == [2, 4, 2]


def test_the_value_that_was_not_asked_for_the_longest_gives_way():
    kept, calls = KeptOnce(2, _one), []
    for key in (1, 2, 1, 3, 1, 2):
        kept.value(key, lambda key=key: calls.append(key))
        assert len(kept) <= 2
    assert calls == [1, 2, 3, 2]


def test_values_take_no_more_memory_than_allowed_but_for_a_single_one():
    kept = KeptOnce(10, float)
    sizes = []
    for key, size in enumerate((4, 5, 3, 30, 2)):
        assert kept.value(key, lambda size=size: size) == size
        sizes.append(len(kept))
    assert sizes == [1, 2, 2, 1, 1]


def test_what_is_kept_travels_between_processes():
    kept = KeptOnce(2, _one)
    kept.value("key", lambda: 3)
    there = pickle.loads(pickle.dumps(kept))
    assert there.value("key", lambda: 4) == 3
    assert pickle.loads(pickle.dumps(KeptOnce(2, _one))).value("key", lambda: 5) == 5
