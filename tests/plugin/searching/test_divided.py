"""If no single value of a constant suits all missions, the constant follows a sensor that differs between missions."""

from __future__ import annotations

from collections.abc import Iterator
from math import log, sqrt

import pytest

from pytest_tarl.patching.mutate import Mutation, mutations
from pytest_tarl.patching.structures import Form
from pytest_tarl.patching.templates import SHIPPED, template
from pytest_tarl.searching.accept import Outcome
from pytest_tarl.searching.attempts import Attempts
from pytest_tarl.searching.candidates import ALWAYS
from pytest_tarl.searching.divided import POWERS, divided, stronger_and_weaker
from pytest_tarl.searching.search import Candidate, Goal, Pair, Trials
from pytest_tarl.searching.suggestions import Suggestions
from pytest_tarl.searching.units import units
from tests.plugin.searching.test_search import operand

GOAL = Goal(tuple(Pair(seed, -5.0) for seed in range(6)), near=8.0, enough=9.0, online=-5.0, passing=True)
SPEED = operand(3, "2.0", 2.0)
(UNIT,) = units([SPEED])
LAW = Form(template(SHIPPED / "above.toml"), "power", (("power", 0.5), ("usual", 1.0)), variable="speed")


def run(candidate: Candidate, seed: int) -> Outcome:
    """Even seeds need the factor 2.2 and odd ones 5; the law fits all with a power of 0.65."""
    (mutation,) = candidate.mutations
    if mutation.form is not None:
        off = log(float(mutation.value) / 1.3)
    else:
        off = log(float(mutation.value) / 2.0 / (2.2 if seed % 2 == 0 else 5.0))
    return Outcome(10.0 - 20.0 * abs(off), abs(off) < 0.1)


def candidate(factor: float) -> Candidate:
    return Candidate(UNIT.mutations(mutations, factor), ALWAYS)


@pytest.mark.parametrize(
    ("seeds", "expected", "episodes"),
    [
        ({2.2: [0, 1], 5.0: [0, 1]}, sqrt(2.2 * 5.0), 0),
        ({2.2: [0, 1], 5.0: [1, 2]}, sqrt(2.2 * 5.0), 1),
        ({2.2: [0, 3], 5.0: [1, 2]}, sqrt(2.2 * 5.0), 2),
        ({2.2: [0, 1], 5.0: [1]}, sqrt(2.2 * 5.0), 1),
        ({2.2: [0], 5.0: [0, 1]}, sqrt(2.2 * 5.0), 1),
        ({2.2: [0], 5.0: [1]}, None, 0),  # neither has failed yet
        ({2.2: [0, 1], 3.0: [0, 1]}, None, 0),  # 3 reaches the goal nowhere
        ({2.2: [0, 1], 2.21: [2, 1]}, None, 1),  # both reach it in the same missions
        ({2.2: [1], 5.0: [1]}, None, 0),
        ({2.2: [0, 1], 0.4: [0, 1]}, None, 0),
    ],
)
def test_values_that_succeed_on_different_missions_divide_them(
    seeds: dict[float, list[int]], expected: float | None, episodes: int
) -> None:
    trials = Trials(run, 99)
    for factor, chosen in seeds.items():
        for seed in chosen:
            trials(candidate(factor), seed)
    spent = trials.spent
    found = divided(UNIT, ALWAYS, 2.2, dict.fromkeys((1.0, *seeds), 0.0), mutations, trials, GOAL)
    assert found == (pytest.approx(expected) if expected else None)
    assert trials.spent - spent == episodes


def test_proposed_exponent_is_tried_first() -> None:
    law = Candidate((Mutation(SPEED, 1.0, form=LAW),), ALWAYS)
    assert [one.mutations[0].value for one in stronger_and_weaker(law)] == list(POWERS)


def test_confirmed_law_is_yielded_once() -> None:
    asked: list[float] = []

    def following(changed: Candidate) -> Iterator[Candidate]:
        asked.append(float(changed.mutations[0].value) / 2.0)
        yield Candidate((Mutation(SPEED, 1.0, form=LAW),), ALWAYS)

    trials = Trials(run, 99)
    search = Attempts(
        (UNIT,), mutations, (ALWAYS,), trials, GOAL, suggestions=Suggestions(following=following)
    )
    found = [
        one
        for factor, pair in ((2.2, 0), (5.0, 1), (2.25, 0))
        for one in search.attempt(UNIT, ALWAYS, factor, pair)
    ]
    assert [(one.mutations[0].form, one.mutations[0].value) for one in found] == [(LAW, 1.3)]
    assert asked == [pytest.approx(sqrt(2.2 * 5.0), rel=1e-3)]
