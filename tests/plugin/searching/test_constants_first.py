"""Constants that gained are refined before a structural change is yielded."""

from __future__ import annotations

from collections.abc import Mapping
from types import SimpleNamespace
from typing import Any

from pytest_tarl.patching.mutate import mutations
from pytest_tarl.searching.accept import Outcome
from pytest_tarl.searching.candidates import ALWAYS
from pytest_tarl.searching.constants_first import CONSTANTS, EPISODES, MADE_OF, Scaled, constants_first
from pytest_tarl.searching.gains import Gains
from pytest_tarl.searching.search import Candidate, Goal, Pair, Trials
from pytest_tarl.searching.units import Unit
from tests.plugin.searching.test_gains import A, B, C
from tests.plugin.searching.test_search import operand

GOAL = Goal(tuple(Pair(seed, 0.0) for seed in range(8)), near=9.0, enough=9.5, online=0.0)
LITERAL = Unit((operand(9, "0.5", 0.5),))
STRUCTURES = [Candidate((), ALWAYS), Candidate((), ALWAYS)]


def found(
    gained: Mapping[Unit, Mapping[float, float]], good: tuple[float, float], easy: int = -1
) -> tuple[list[str], list[tuple[str, int]]]:
    """Return what is yielded and what ran if A earns 10 between two factors, everywhere or only on the easy seed."""
    ran = []

    def run(candidate: Candidate, seed: int) -> Outcome:
        (mutation,) = candidate.mutations
        by = float(mutation.value)
        ran.append((f"{mutation.operand.code} {by:g}", seed))
        held = mutation.operand.code == "A" and good[0] <= by <= good[1] and easy in (-1, seed)
        return Outcome(10.0 if held else 1.5 if abs(by - 2.2) < 0.1 else 0.0, held)

    gains = Gains(1.0)
    for unit, by_factor in gained.items():
        for factor, gain in by_factor.items():
            gains.enter((unit, ALWAYS), factor, gain)
    search: Any = SimpleNamespace(
        units=(), mutate=mutations, gains=gains, slack=1.0, refused=set(), ran_on=lambda *_: 3
    )
    trials = Trials(run, 100)
    yielded = [
        "structure"
        if not one.mutations
        else f"{one.mutations[0].operand.code} {float(one.mutations[0].value):g}"
        for one in constants_first(iter(STRUCTURES), search, trials, GOAL)
    ]
    return yielded, ran


NARROW = {1.0: 0.0, 2.2: 1.5, 5.0: 0.0}


def test_small_gain_is_refined_on_its_own_seed() -> None:
    yielded, ran = found({A: NARROW}, (2.5, 2.9))
    assert yielded == ["A 2.701", "structure", "structure"]
    refined = [words for words, seed in ran if seed == 3]
    assert refined == ["A 2.2", "A 5", "A 1.483", "A 3.317", "A 1.806", "A 2.701"]
    assert {seed for words, seed in ran if words == "A 2.701"} > {3}  # confirmed on further seeds


def test_few_episodes_are_spent_without_a_good_value() -> None:
    yielded, ran = found({A: NARROW, B: NARROW, C: NARROW}, (7.0, 8.0))
    assert yielded == ["structure", "structure"]
    assert len({words[0] for words, _ in ran}) == CONSTANTS
    assert len(ran) <= CONSTANTS * (EPISODES + 1)


def test_value_good_on_one_seed_is_not_yielded() -> None:
    assert found({A: NARROW}, (2.5, 2.9), easy=3)[0] == ["structure", "structure"]


def test_literals_and_constants_without_a_gain_are_left_out() -> None:
    yielded, ran = found({LITERAL: NARROW, A: {2.2: 0.5}}, (1.0, 9.0))
    assert (yielded, ran) == (["structure", "structure"], [])


SMALLEST = Unit((operand(4, "0.1", 0.1),))
OTHERS = tuple(Unit((operand(line, f"{line}.0", float(line)),)) for line in (2, 3, *range(5, 15)))
COMMAND = Scaled(2.0, tuple(("node.py", line, line) for line in (4, 2, *range(5, 15))))


def in_place_of_a_factor(good: float, refused: bool = False) -> tuple[list[str], list[str]]:
    """Return what is yielded and what ran if the literal 0.1 of a scaled command earns 10 at one value."""
    ran: list[str] = []

    def run(candidate: Candidate, seed: int) -> Outcome:
        (mutation,) = candidate.mutations
        changed = f"{mutation.operand.code} → {mutation.value:g}"
        ran.append(changed)
        held = changed == f"0.1 → {good:g}"
        return Outcome(10.0 if held else 0.0, held)

    search: Any = SimpleNamespace(
        units=(*OTHERS, SMALLEST),
        mutate=mutations,
        gains=Gains(1.0),
        slack=1.0,
        refused={(SMALLEST, ALWAYS)} if refused else set(),
    )
    yielded = [
        "structure" if not one.mutations else one.mutations[0].operand.code
        for one in constants_first(iter(STRUCTURES[:1]), search, Trials(run, 100), GOAL, lambda _: COMMAND)
    ]
    return yielded, list(dict.fromkeys(ran))


def test_constant_of_a_command_comes_before_its_factor() -> None:
    yielded, ran = in_place_of_a_factor(0.2)
    assert yielded == ["0.1", "structure"]
    assert ran[:2] == ["0.1 → 0.2", "2.0 → 4"]  # the statement that is nearest to the command comes first
    assert len(ran) == MADE_OF
    assert not any(one.startswith("3.0") for one in ran)  # another command


def test_factor_stays_if_no_constant_suffices() -> None:
    assert in_place_of_a_factor(0.3)[0] == ["structure"]
    assert in_place_of_a_factor(0.2, refused=True)[0] == ["structure"]
