import pickle

import pytest

from uvshear.errors import InputError
from uvshear.reproduce.names import SCALES, TARGETS
from uvshear.reproduce.registry import targets_at


def test_some_targets_in_the_order_of_the_page():
    first, second, *_ = TARGETS
    chosen = targets_at("quick", (second, first), 7)
    assert [target.name for target in chosen] == [first, second]
    assert {target.seed for target in chosen} == {7}


@pytest.mark.parametrize(
    ("scale", "names", "message"),
    [
        ("large", (), "scale 'large' is not known; the known scales are quick, paper"),
        ("quick", ("table-9",), "target 'table-9' is not known; the known targets are psf-images"),
    ],
)
def test_what_is_not_known_is_refused(scale, names, message):
    with pytest.raises(InputError, match=message):
        targets_at(scale, names)


@pytest.mark.parametrize("scale", SCALES)
def test_targets_and_tasks_can_be_sent_to_workers_and_parts_have_names_of_files(scale):
    for target in targets_at(scale):
        assert pickle.loads(pickle.dumps(target)) == target
        tasks = target.tasks()
        assert tasks
        pickle.dumps(tasks)
        assert all(name.replace("-", "").replace(".", "").isalnum() for name in tasks)
