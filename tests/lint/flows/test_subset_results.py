"""Results are extended from the results for large subsets, and do not depend on which subsets are known."""

from __future__ import annotations

from dataclasses import dataclass

from hypothesis import given
from hypothesis import strategies as st

from tarl_lint.flows.subset_results import MAX_KEPT, Nearest


@dataclass(frozen=True)
class Total:
    """The sum of some nodes."""

    nodes: frozenset[int] | set[int]
    value: int


EMPTY = Total(frozenset(), 0)


class Sums:
    """Adds nodes to a known sum; notes how many nodes it has added."""

    def __init__(self) -> None:
        self.added: list[int] = []

    def extended(self, nodes, known: Total) -> Total:
        news = nodes - known.nodes
        assert known.nodes <= nodes
        self.added.append(len(news))
        return Total(nodes, known.value + sum(news))


@given(st.lists(st.tuples(st.sets(st.integers(0, 9)), st.integers(0, 1)), max_size=2 * MAX_KEPT))
def test_every_request_gets_the_result_of_the_requested_nodes(requests):
    nearest = Nearest(EMPTY, Sums().extended, worthwhile=1)
    for nodes, kind in requests:
        assert nearest.of(nodes, kind) == Total(nodes, sum(nodes))


def test_intersection_of_two_sets_is_cached():
    sums = Sums()
    nearest = Nearest(EMPTY, sums.extended, worthwhile=3)
    shared = set(range(10))
    for more in (20, 21, 22):
        nearest.of(shared | {more}, "kind")
    assert sums.added == [11, 10, 1, 1]


def test_sets_of_different_kinds_are_not_compared():
    sums = Sums()
    nearest = Nearest(EMPTY, sums.extended, worthwhile=3)
    nearest.of(set(range(10)), "one")
    nearest.of(set(range(11)), "other")
    assert sums.added == [10, 11]


def test_a_given_result_for_a_subset_is_extended():
    sums = Sums()
    nearest = Nearest(EMPTY, sums.extended, worthwhile=3)
    assert nearest.of({1, 2, 3}, "kind", Total({1, 2}, 3)).value == 6
    assert sums.added == [1]
