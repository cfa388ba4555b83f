"""Sums in a fixed order."""

import numpy as np
import pytest

from uvshear.execution.tree import FAN, tree_of, tree_sum

NUMBERS = [1, 2, 7, 8, 9, 15, 16, 17, 63, 64, 65, 73, 128, 511, 512, 513, 600]


def _added(total: str, more: str) -> str:
    return f"({total}+{more})"


def _joined(group) -> str:
    total = group[0]
    for more in group[1:]:
        total = _added(total, more)
    return total


@pytest.mark.parametrize("number", NUMBERS)
def test_both_trees_add_the_same_results_in_the_same_order(number) -> None:
    leaves = [str(k) for k in range(number)]
    total = tree_sum(iter(leaves), _added)
    assert total == tree_of(leaves, _joined)
    assert total.replace("(", "").replace(")", "") == "+".join(leaves)


def test_few_results_are_added_one_after_the_other() -> None:
    assert tree_sum("abc", _added) == "((a+b)+c)"


def test_sums_of_groups_are_added_after_them() -> None:
    groups = [_joined([str(k) for k in range(first, first + FAN)]) for first in (0, FAN)]
    assert tree_sum(map(str, range(2 * FAN + 1)), _added) == f"({_joined(groups)}+{2 * FAN})"


def test_a_single_sum_is_held_for_each_level() -> None:
    held, most = 0, 0

    def results():
        nonlocal held, most
        for _ in range(FAN**2):
            held += 1
            most = max(most, held)
            yield np.ones(1)

    def add(total, more):
        nonlocal held
        held -= 1
        total += more
        return total

    assert tree_sum(results(), add)[0] == FAN**2
    assert most <= 3
