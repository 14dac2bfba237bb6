"""Screening: a few runs over many operands show which of them matter."""

from __future__ import annotations

import math

import numpy as np
import pytest

from pytest_tarl.patching.mutate import mutations
from pytest_tarl.searching.accept import Outcome
from pytest_tarl.searching.candidates import ALWAYS
from pytest_tarl.searching.forward_selection import ForwardSelection
from pytest_tarl.searching.screening import main_effects, screened, worth_screening
from pytest_tarl.searching.search import Candidate, Goal, Pair, Trials
from pytest_tarl.searching.sweep import Sweep
from pytest_tarl.searching.units import units
from pytest_tarl.seeds import generator
from tests.plugin.searching.test_forward_selection import operand

GOAL = Goal(tuple(Pair(seed, 0.0) for seed in range(6)), near=9.0, enough=9.0, online=0.0)


def test_screening_separates_main_effects() -> None:
    draws = np.random.default_rng(3)
    design = (draws.random((60, 20)) < 0.2).astype(float)
    effects = main_effects(design, design @ np.eye(20)[7] * 5.0)
    assert int(effects.argmax()) == 7


@pytest.mark.parametrize(("many", "most"), [(60, 140), (160, 300)])
def test_screening_runs_grow_more_slowly_than_constants(many: int, most: int) -> None:
    gains = [operand(line, "1.0", 1.0) for line in range(many)]
    right = gains[many * 3 // 4]

    def run(candidate: Candidate, seed: int) -> Outcome:
        factors = {m.operand: float(m.value) for m in candidate.mutations}
        total = 10.0 - 6.0 * abs(math.log(3.0 / factors.get(right, 1.0)))
        total -= sum(0.5 for operand in factors if operand is not right)
        return Outcome(total, total > 8.0)

    goal = Goal(
        tuple(Pair(seed, run(Candidate((), ALWAYS), seed).total) for seed in range(6)),
        near=9.0,
        enough=9.0,
        online=3.4,
    )
    trials = Trials(run, 1000)
    search = Sweep(gains, mutations, (ALWAYS,), trials, goal, generator(0, "sweep"))
    found = next(search.candidates())
    assert [m.operand for m in found.mutations] == [right]
    assert trials.spent < most


def test_lucky_run_loses_unneeded_parts() -> None:
    gains = [operand(line, "1.0", 1.0) for line in range(50)]

    def run(candidate: Candidate, seed: int) -> Outcome:
        good = any(m.operand == gains[20] and m.value > 1 for m in candidate.mutations)
        return Outcome(10.0 if good else 0.0, good)

    together = ForwardSelection(units(gains), mutations, Trials(run, 500), GOAL, {}, 0.1)
    found = list(screened(together, ALWAYS, generator(1, "sweep")))
    assert worth_screening(together.units)
    assert {m.operand for candidate in found for m in candidate.mutations} <= {gains[20]}


def test_screened_change_is_compared_with_named_constants() -> None:
    """Scaling a literal and lowering the threshold in the next line have the same effect; the threshold has a name."""
    literals = [operand(line, "1.0", 1.0) for line in range(0, 120, 2)]
    scale = literals[30]
    threshold = operand(scale.span.line + 1, "THRESHOLD", 1.0, named=True)

    def run(candidate: Candidate, seed: int) -> Outcome:
        values = {one.operand: float(one.value) for one in candidate.mutations}
        right = values.get(scale, 1.0) > 2.0 or values.get(threshold, 1.0) < 0.5
        return Outcome(10.0 if right else 0.0, right)

    sweep = Sweep(
        (*literals, threshold), mutations, (ALWAYS,), Trials(run, 400), GOAL, generator(0, "screening")
    )
    assert [one.operand for one in next(sweep.candidates()).mutations] == [threshold]


def test_named_constants_are_tried_before_a_screening() -> None:
    literals = [operand(line, "1.0", 1.0) for line in range(60)]
    names = [operand(line, f"NAME_{line}", 1.0, named=True) for line in range(100, 104)]

    def run(candidate: Candidate, seed: int) -> Outcome:
        values = {one.operand: float(one.value) for one in candidate.mutations}
        right = 1.07 < values.get(names[2], 1.0) < 1.13
        outputs = (("out", tuple(values.get(one, 1.0) for one in names)),)
        return Outcome(10.0 if right else 0.0, right, steps=9, outputs=outputs)

    def unchanged(seed: int) -> Outcome:
        return run(Candidate((), ALWAYS), seed)

    trials = Trials(run, 400, unchanged=unchanged)
    sweep = Sweep((*literals, *names), mutations, (ALWAYS,), trials, GOAL, generator(0, "sweep"))
    found = next(sweep.candidates())
    assert [one.operand for one in found.mutations] == [names[2]]
    assert not any("→" in label for label in trials.labels)


def test_literals_are_screened_without_named_constants() -> None:
    literals = [operand(line, "1.0", 1.0) for line in range(60)]
    names = [operand(line, f"NAME_{line}", 1.0, named=True) for line in range(100, 104)]

    def run(candidate: Candidate, seed: int) -> Outcome:
        values = {one.operand: float(one.value) for one in candidate.mutations}
        right = values.get(literals[40], 1.0) > 2.0
        return Outcome(10.0 if right else 0.0, right)

    trials = Trials(run, 400)
    sweep = Sweep((*literals, *names), mutations, (ALWAYS,), trials, GOAL, generator(0, "sweep"))
    assert [one.operand for one in next(sweep.candidates()).mutations] == [literals[40]]
    together = [label for label in trials.labels if ", " in label]
    assert together
    assert not any("NAME" in label for label in together)
