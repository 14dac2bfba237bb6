"""The semantics of formulas, compared with the definition on generated formulas and signals."""

from __future__ import annotations

import re

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

pytest.importorskip("rtamt")

from pytest_tarl.errors import SettingsError
from pytest_tarl.formulas.parsing import Formula, formula
from pytest_tarl.formulas.robustness import course, lost_at, robustness, running
from pytest_tarl.formulas.signals import Samples, Timeline
from tests.plugin.formulas import oracle

NAMES = ("x", "y")
SECOND = 10**9

numbers = st.integers(-3, 3)
windows = st.none() | st.tuples(st.integers(0, 3), st.integers(0, 3)).map(lambda ab: (ab[0], ab[0] + ab[1]))
comparisons = st.tuples(st.sampled_from(["<", "<=", ">", ">=", "==", "!="]), st.sampled_from(NAMES), numbers)


def nested(inner: st.SearchStrategy[oracle.Tree]) -> st.SearchStrategy[oracle.Tree]:
    return st.one_of(
        st.tuples(st.just("not"), inner),
        st.tuples(st.sampled_from(["and", "or", "->", "<->", "xor"]), inner, inner),
        st.tuples(st.sampled_from(["always", "eventually", "once", "historically"]), windows, inner),
        st.tuples(st.sampled_from(["until", "since"]), windows, inner, inner),
    )


trees = st.recursive(comparisons, nested, max_leaves=5)
# the left sides of `since` and of timed `until` must hold to the exact nanosecond
untied = trees.filter(
    lambda tree: not {"since", "until["} & set(re.findall(r"since|until\[", oracle.text(tree, "")))
)


@st.composite
def worlds(draw: st.DrawFn) -> oracle.World:
    """Draw signals that each change at their own instants."""
    end = draw(st.integers(0, 8))
    signals = {}
    for name in NAMES:
        column = [draw(numbers)]
        while len(column) <= end:
            column += [draw(numbers)] * draw(st.integers(1, 4))
        signals[name] = [float(value) for value in column[: end + 1]]
    return oracle.World(signals, end)


def samples(world: oracle.World, apart: int = 1) -> dict[str, Samples]:
    line = Timeline(NAMES)
    for name in NAMES:
        for time, value in enumerate(world.signals[name]):
            line.give(name, value, time * apart)
    return line.samples(NAMES)


def read(tree: oracle.Tree, unit: str = "ns", size: float = 1) -> Formula | None:
    """Parse a formula; return None if no episode can judge it (other tests cover this case)."""
    try:
        return formula("here", oracle.text(tree, unit, size), NAMES)
    except SettingsError as problem:
        if "beginning of the episode" not in str(problem):
            raise
        return None


@settings(max_examples=400, deadline=None)
@given(trees, worlds())
def test_robustness_equals_the_definition(tree: oracle.Tree, world: oracle.World) -> None:
    read_formula = read(tree)
    if read_formula is not None:
        found = robustness(course(read_formula, samples(world)), world.end)
        assert found == oracle.value(tree, world)


@settings(max_examples=200, deadline=None)
@given(untied, worlds(), st.sampled_from([("s", 0.5), ("ms", 250), ("", 2)]))
def test_robustness_does_not_depend_on_the_time_scale(
    tree: oracle.Tree, world: oracle.World, scale: tuple[str, float]
) -> None:
    unit, size = scale
    apart = int(size * {"s": SECOND, "": SECOND, "ms": 10**6}[unit])
    read_formula = read(tree, unit, size)
    if read_formula is not None:
        found = robustness(course(read_formula, samples(world, apart)), world.end * apart)
        assert found == oracle.value(tree, world)


@settings(max_examples=300, deadline=None)
@given(trees, worlds())
def test_robustness_is_positive_if_the_formula_holds(tree: oracle.Tree, world: oracle.World) -> None:
    read_formula = read(tree)
    if read_formula is not None:
        found = robustness(course(read_formula, samples(world)), world.end)
        assert (found > 0) == oracle.true(tree, world)[0]


@settings(max_examples=300, deadline=None)
@given(trees, worlds())
def test_running_robustness_equals_robustness_of_each_prefix(tree: oracle.Tree, world: oracle.World) -> None:
    read_formula = read(tree)
    if read_formula is None:
        return
    found = running(course(read_formula, samples(world)), list(range(world.end + 1)))
    known = [
        oracle.World({name: column[: end + 1] for name, column in world.signals.items()}, end)
        for end in range(world.end + 1)
    ]
    assert found == [oracle.value(tree, one) for one in known]


@settings(max_examples=300, deadline=None)
@given(trees, worlds(), worlds())
def test_unsatisfiable_formula_is_violated_at_once(
    tree: oracle.Tree, world: oracle.World, following: oracle.World
) -> None:
    read_formula = read(tree)
    if read_formula is None:
        return
    instants = list(range(world.end + 1))
    lost = lost_at(course(read_formula, samples(world)), instants)
    if lost is None:
        return
    known = lost
    signals = {name: [*world.signals[name][: known + 1], *following.signals[name]] for name in NAMES}
    assert oracle.value(tree, oracle.World(signals, known + 1 + following.end)) <= 0
