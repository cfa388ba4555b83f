"""Sums of many results, always added in the same order, whoever adds them."""

from collections.abc import Callable, Iterable, Sequence
from functools import reduce
from typing import Final, TypeVar

Node = TypeVar("Node")

FAN: Final = 8
"""Number of results that are added one after the other; sums of so many are then added in the same way, and so on. On a
cluster the additions of a group are one task."""


def tree_sum(results: Iterable[Node], add: Callable[[Node, Node], Node]) -> Node:
    """Return the sum of one or more results; a single sum is held for each level of the tree.

    ``add(total, more)`` may change the total and return it.
    """
    levels: list[tuple[int, Node]] = []
    for result in results:
        node, level = result, 0
        while True:
            if level == len(levels):
                levels.append((1, node))
                break
            count, total = levels[level]
            node, count = (add(total, node), count + 1) if count else (node, 1)
            if count < FAN:
                levels[level] = count, node
                break
            levels[level] = 0, node
            level += 1
    left = [node for count, node in levels if count]
    # Lower levels hold later results.
    return reduce(lambda later, earlier: add(earlier, later), left[1:], left[0])


def tree_of(nodes: Sequence[Node], join: Callable[[Sequence[Node]], Node]) -> Node:
    """Build the same tree, whose nodes are not known yet: ``join`` stands for the sum of a group, in its order."""
    left: list[list[Node]] = []
    while True:
        groups = [list(nodes[first : first + FAN]) for first in range(0, len(nodes), FAN)]
        full = [group for group in groups if len(group) == FAN]
        left.append(groups[-1] if len(groups) > len(full) else [])
        if not full:
            break
        nodes = [join(group) for group in full]
    later: list[Node] = []
    for own in left:
        group = own + later
        later = [join(group)] if len(group) > 1 else group
    (root,) = later
    return root
