"""One task after the other."""

from uvshear.execution import Serial


def test_there_is_one_worker() -> None:
    assert Serial().workers == 1


def test_a_task_begins_when_its_result_is_asked_for() -> None:
    begun = []
    results = Serial().map(begun.append, range(3))
    assert begun == []
    next(results)
    assert begun == [0]
