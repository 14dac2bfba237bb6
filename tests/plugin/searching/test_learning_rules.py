"""Figures of the searches, worked out by hand: ε-greedy learning, acceptance numbers, screening, next factors."""

from __future__ import annotations

from itertools import product
from math import comb, sqrt
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from pytest_tarl.errors import RepairError
from pytest_tarl.patching.mutate import mutations
from pytest_tarl.searching.accept import Outcome
from pytest_tarl.searching.acceptance_numbers import NEVER, acceptance_numbers
from pytest_tarl.searching.candidates import ALWAYS
from pytest_tarl.searching.epsilon_greedy import EpsilonGreedy
from pytest_tarl.searching.halving import Halving
from pytest_tarl.searching.refining import between
from pytest_tarl.searching.screening import BLOCK, MANY, blocks, main_effects, worth_screening
from pytest_tarl.searching.search import FACTORS, BudgetSpentError, Candidate, Goal, Pair, Trials
from tests.plugin.searching.test_forward_selection import operand


class Generator:
    """Stand-in for a random generator: the given numbers in turn."""

    def __init__(self, *numbers: float) -> None:
        self.numbers = list(numbers)
        self.ranges: list[int] = []

    def random(self) -> float:
        return self.numbers.pop(0)

    def integers(self, most: int) -> int:
        self.ranges.append(most)
        return int(self.numbers.pop(0))


def learner(count: int, *numbers: float, totals: Any = ()) -> EpsilonGreedy:
    made = EpsilonGreedy.__new__(EpsilonGreedy)
    given: Any = made
    given.actions = list(range(count))
    given.generator = Generator(*numbers)
    given.q, given.seen, given.refused = {}, {}, set()
    given.goal = SimpleNamespace(pairs=[SimpleNamespace(total=-3.0), SimpleNamespace(total=-5.0)])
    results = iter(totals)

    def trials(_action: int, _seed: int) -> Any:
        found = next(results)
        if isinstance(found, Exception):
            raise found
        return SimpleNamespace(total=found)

    given.trials = trials
    return made


def test_half_of_the_choices_explore_untried_mutations() -> None:
    made = learner(3, 0.49, 1)
    made.seen = {1: [0.0]}
    assert made._choose(0) == 2  # the second of the untried 0 and 2
    assert made.generator.ranges == [2]  # type: ignore[attr-defined]


def test_best_mutation_is_exploited() -> None:
    made = learner(3, 0.5, 0.2)
    made.seen = {0: [1.0, 3.0], 2: [1.5]}
    assert made._choose(0) == 0
    made.q = {(0, 2): 9.0}
    made.generator = Generator(0.5, 0.21)  # type: ignore[assignment]
    assert made._choose(0) == 2
    made.generator = Generator(0.5, 0.19, 1)  # type: ignore[assignment]
    assert made._choose(0) == 1
    assert made.generator.ranges == [3]  # type: ignore[attr-defined]


def test_before_the_first_result_a_choice_is_random() -> None:
    assert learner(4, 0.5, 3)._choose(0) == 3


def test_one_draw_decides_to_exploit() -> None:
    made = learner(2, 0.9)
    made.seen = {0: [1.0], 1: [2.0]}
    assert made._choose(0) == 1


def test_values_are_learned_by_sarsa() -> None:
    # 0.5, 1: action 1 although nothing is known; then twice: explore the untried 0 (0.1, 0), exploit 1 (0.9)
    made = learner(2, 0.5, 1, 0.1, 0, 0.9, 0.9, totals=[4.0, 2.0, 6.0])
    made.seeds = (1, 2, 3)
    made.generator.numbers += [0.9]  # type: ignore[attr-defined]
    made._learn()
    assert made.seen == {1: [4.0, 6.0], 0: [2.0]}
    # step 1: Q(0, 1) starts at its total 4; Q(1, 0) is unknown, so 4: 4 + 0.3 (2 + 0.5 · 4 - 4) = 4
    # step 2: Q(1, 0) starts at 2; the next action is 1, and Q(0, 1) = 4: 2 + 0.3 (1 + 0.5 · 4 - 2) = 2.3
    # step 3: Q(0, 1) = 4; the next action is 1, and Q(1, 1) is unknown, so 6: 4 + 0.3 (3 + 0.5 · 6 - 4) = 4.6
    assert made.q == pytest.approx({(0, 1): 4.6, (1, 0): 2.3})


def test_unwritable_mutation_is_worst() -> None:
    made = learner(1, 0.5, 0, 0.9, totals=[RepairError("no"), BudgetSpentError()])
    made.seeds = (1, 2)
    made._learn()
    assert made.refused == {0}
    assert made.seen == {0: [-5.0]}


@pytest.mark.parametrize(("budget", "episodes"), [(1, 1), (3, 2), (30, 20), (300, 200), (3000, 200)])
def test_a_third_of_the_budget_is_kept_for_confirmation(budget: int, episodes: int) -> None:
    assert EpsilonGreedy.episodes(budget) == episodes


def binomial(n: int, k: int, p: float) -> float:
    return comb(n, k) * p**k * (1 - p) ** (n - k)


@pytest.mark.parametrize(("look", "tolerated"), [(59, 0.05), (58, 0.05), (93, 0.05), (10, 0.5), (4, 0.9)])
def test_single_check_has_the_clopper_pearson_bound(look: int, tolerated: float) -> None:
    (found,) = acceptance_numbers((look,), tolerated, 0.05)
    tail = np.cumsum([binomial(look, k, tolerated) for k in range(look + 1)])
    assert found == int((tail <= 0.05).sum()) - 1
    if (look, tolerated) == (59, 0.05):
        assert found == 0
    if (look, tolerated) == (58, 0.05):
        assert found == NEVER


def test_checks_together_keep_the_risk() -> None:
    looks, tolerated, risk = (4, 8), 0.5, 0.2
    first, second = acceptance_numbers(looks, tolerated, risk)
    risks = {}
    for numbers in product(range(NEVER, 5), range(NEVER, 9)):
        early = sum(binomial(4, k, 0.5) for k in range(numbers[0] + 1))
        late = sum(
            binomial(4, k, 0.5) * binomial(4, j, 0.5)
            for k in range(numbers[0] + 1, 5)
            for j in range(max(0, numbers[1] - k) + 1)
            if k + j <= numbers[1]
        )
        risks[numbers] = early, early + late
    best = max(k for k in range(NEVER, 5) if risks[k, NEVER][0] <= risk * sqrt(0.5))
    assert first == best
    assert second == max(k for k in range(NEVER, 9) if risks[best, k][1] <= risk)


def test_main_effects_equal_the_results_of_ridge_regression() -> None:
    # two runs of one column each: (1 + 1) effect = gain
    assert main_effects(np.eye(2), np.array([4.0, -2.0])).tolist() == [2.0, -1.0]
    # one column in two runs: (2 + 1) effect = sum of the gains
    assert main_effects(np.ones((2, 1)), np.array([3.0, 6.0])).tolist() == [3.0]


def test_many_constants_are_split_into_blocks() -> None:
    many: Any = list(range(MANY + 1))
    assert worth_screening(many) is True
    assert worth_screening(many[:-1]) is False
    assert [len(block) for block in blocks(many)] == [BLOCK, BLOCK, 1]
    assert [one for block in blocks(many) for one in block] == many
    assert blocks(many[:-1]) == [many[:-1]]
    assert blocks([]) == []


@pytest.mark.parametrize(
    ("gains", "wanted", "factors"),
    [
        ({1.0: 0.0, 2.0: 5.0, 4.0: 0.0}, 10.0, [1.414, 2.828]),
        ({2.0: 5.0, 4.0: 1.0}, 10.0, [0.87, 2.828]),  # outwards to 2 / 2.3
        ({2.0: 1.0, 4.0: 5.0}, 10.0, [2.828, 9.2]),
        ({-2.0: 5.0, -4.0: 1.0, 2.0: 0.0}, 10.0, [-0.87, -2.828]),
        ({2.0: 0.0, 4.0: -1.0}, 10.0, []),
        ({2.0: 1.0, 2.1: 0.9, 1.9: 0.9}, 10.0, []),  # nearer than the ratio 1.1
        ({2.0: 9.0, 2.1: 8.9, 1.9: 8.9}, 10.0, [1.949, 2.049]),  # almost the wanted gain: down to 1.02
        ({2.0: 8.9, 2.1: 8.8, 1.9: 8.8}, 10.0, []),
        ({2.0: 4.0, 2.1: 2.0, 1.9: 2.0}, 10.0, [1.949, 2.049]),  # a sharp peak with 40 % of the wanted gain
        ({2.0: 4.0, 2.1: 2.1, 1.9: 2.0}, 10.0, []),
        ({2.0: 3.9, 2.1: 1.0, 1.9: 1.0}, 10.0, []),
        ({2.0: 9.5, 2.03: 9.0, 1.97: 9.0}, 10.0, []),  # nearer than the ratio 1.02
    ],
)
def test_the_next_factors_lie_halfway_to_the_neighbours(
    gains: dict[float, float], wanted: float, factors: list[float]
) -> None:
    assert between(gains, wanted) == factors


def test_halving_confirms_on_later_seeds() -> None:
    """All changes ran on the first seed and were chosen by it, so only the next seeds are independent evidence."""
    ran: list[int] = []

    def run(candidate: Candidate, seed: int) -> Outcome:
        ran.append(seed)
        right = any(mutation.value == FACTORS[0] for mutation in candidate.mutations)
        return Outcome(10.0 if right else 0.0, right)

    pairs = tuple(Pair(seed, 0.0) for seed in range(8))
    goal = Goal(pairs, near=9.0, enough=9.5, online=0.0)
    search = Halving((operand(3, "1.0", 1.0),), mutations, (ALWAYS,), Trials(run, 300), goal)
    assert next(search.candidates()).mutations[0].value == FACTORS[0]
    assert ran == [0] * len(FACTORS) + [1, 2, 3, 4, 5]
