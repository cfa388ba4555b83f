from uvshear.reproduce.names import PAPER, QUICK, SCALES, TARGETS
from uvshear.reproduce.registry import targets_at


def test_the_names_are_those_of_the_targets_in_their_order():
    for scale in SCALES:
        targets = targets_at(scale)
        assert [target.name for target in targets] == list(TARGETS)
        assert all(target.title for target in targets)
    assert set(SCALES) == {QUICK, PAPER}
