"""Which parts of state machines and behaviour trees depend on the outcomes of other parts."""

from __future__ import annotations

import pytest

from tarl_lint.interpret.run_order import Group, Part, dependences

STATUSES = frozenset(["good", "bad"])


def group(kind, members, ways=(), **more):
    made = Group(kind, ways={(label, outcome): {to: None} for label, outcome, to in ways}, **more)
    for member in members:
        made.add(member, member)
    return made


def chain(*members, goes_on="good"):
    return group("chain", members, goes_on=goes_on, offers=STATUSES)


CASES = {
    "a chain": ({"w": chain("a", "b", "c")}, {}, {"b a", "c b"}),
    "a chain after a certain outcome": ({"w": chain("a", "b")}, {"a": {"good"}}, set()),
    "a chain that never goes on": ({"w": chain("a", "b")}, {"a": {"bad"}}, set()),
    "a chain in a chain": ({"w": chain("v", "c"), "v": chain("a", "b")}, {}, {"b a", "c b"}),
    "a chain that any outcome continues": (
        {"w": chain("v", "c"), "v": group("wrapper", ["a"], renames={"bad": "good"}, offers=STATUSES)},
        {},
        set(),
    ),
    "a wrapper that changes nothing": (
        {"w": chain("v", "c"), "v": group("wrapper", ["a"], offers=STATUSES)},
        {},
        {"c a"},
    ),
    "a fork": (
        {"w": chain("f", "c"), "f": group("fork", ["a", "b"], offers=STATUSES)},
        {},
        {"a in f", "b in f", "c f?"},
    ),
    "a chain in a fork": (
        {"w": chain("f", "c"), "f": group("fork", ["v"]), "v": chain("a", "b")},
        {},
        {"v in f", "a in f", "b in f", "b a", "c f?"},
    ),
    "two ways that meet": (
        {
            "w": group(
                "machine", "abcd", [("a", "good", "b"), ("a", "bad", "c"), ("b", "x", "d"), ("c", "x", "d")]
            )
        },
        {"b": {"x"}, "c": {"x"}},
        {"b a", "c a"},
    ),
    "a way to an outcome of the machine": (
        {"w": group("machine", "ab", [("a", "good", "b"), ("a", "bad", "end")])},
        {},
        {"b a"},
    ),
    "a way that is not stated ends the machine": (
        {"w": group("machine", "ab", [("a", "good", "b")])},
        {"a": {"good", "bad"}},
        {"b a"},
    ),
    "an endless loop": (
        {"w": group("machine", "ab", [("a", "good", "b"), ("a", "bad", "a"), ("b", "x", "a")])},
        {"b": {"x"}},
        {"a a"},
    ),
    "another initial state": (
        {"w": group("machine", "ab", [("b", "good", "a"), ("b", "bad", "end")], first="b")},
        {"a": {"x"}},
        {"a b"},
    ),
    "a group in itself": ({"w": chain("a", "w")}, {}, set()),
    "groups in each other": ({"w": chain("v"), "v": chain("w", "a"), "u": chain("a", "b")}, {}, {"b a"}),
    "an empty group": ({"w": chain("v", "b"), "v": chain()}, {}, {"b v"}),
}


@pytest.mark.parametrize("title", CASES)
def test_state_depends_on_the_outcomes_that_lead_to_it(title):
    groups, outcomes, wanted = CASES[title]
    found = dependences(groups, lambda part: frozenset(outcomes.get(part, ())))
    text = {None: "{0} {1}?", frozenset(): "{0} in {1}"}
    named = {text.get(one.outcomes, "{0} {1}").format(one.part, one.decider) for one in found}
    assert named == wanted


def test_very_deep_and_wide_trees_are_cut():
    deep = {str(number): chain("a", str(number + 1)) for number in range(100)}
    assert len(list(dependences(deep, lambda _: frozenset()))) < 100
    wide = {
        "w": chain(*(f"v{n}" for n in range(50))),
        **{f"v{n}": chain(*map(str, range(100))) for n in range(50)},
    }
    assert len({one.part for one in dependences(wide, lambda _: frozenset(["good"]))}) == 0


def test_subtree_outcomes_are_known_if_all_answers_are_known():
    part = Part(1, 2)
    assert part.outcomes() == frozenset()
    part.answers[3] = frozenset(["good"])
    part.answers[4] = frozenset(["good", "bad"])
    assert part.outcomes() == STATUSES
    part.answers[5] = None
    assert part.outcomes() == frozenset()
