"""Regression tests: which missions of other tests are run with a candidate, and when they count as lost."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from pytest_tarl import Sensor
from pytest_tarl.repairing.regression_tests import EPISODES, MOST, beside
from pytest_tarl.searching.accept import Outcome

X = Sensor("x", topic="/x", field="x", low=0, high=10, bins=10)
Y = Sensor("y", topic="/y", field="y", low=0, high=10, bins=10)
FIRST = 100  # seed of the first recorded episode
NODE = Path("/project/node.py")


def neighbour(
    number: int = 0, *, holding: range = range(3, 40), sensors: tuple[Sensor, ...] = (X,), **more: Any
) -> Any:
    """Return a recorded test of 40 episodes; episode i earned i, and those in `holding` visited a cell at x = 7."""
    episode = np.arange(40)
    sample = SimpleNamespace(
        seeds=tuple(FIRST + 2 * n for n in range(40)),
        episodes=40,
        cells=((2,), (7,)),
        chain=SimpleNamespace(episode=episode, cell=np.array([int(n in holding) for n in range(40)])),
        total=episode.astype(float),
        passed=np.ones(40, bool),
    )
    about = {"nodes": (NODE,), "drift": None, "margin": 0.5, "rollout": f"rollout {number}"} | more
    return SimpleNamespace(
        test=f"test_{number}.py::test", fixture=SimpleNamespace(sample=sample, sensors=sensors), **about
    )


class Mutants:
    """Log all runs; a mission earns the number of its episode plus `change`."""

    def __init__(
        self, neighbours: list[Any], change: float = 0.0, *, permanent: bool = False, fails: int = -1
    ) -> None:
        self.ran: list[tuple[str, int]] = []
        self.changed, self.fails = change, fails
        self.order = SimpleNamespace(
            neighbours=lambda: neighbours, root=Path("/project"), permanent=permanent
        )

    def source(self, _candidate: object) -> dict[Path, str]:
        return {NODE: ""}

    def run_at(self, rollout: str, worst: float, candidate: object, seed: int, _drift: object) -> Outcome:
        self.ran.append((rollout, seed))
        assert worst == 0.0
        change = self.changed if candidate is not None else 0.0
        return Outcome((seed - FIRST) / 2 + change, (seed - FIRST) / 2 != self.fails)


def guard(low: float, high: float, sensor: Sensor = X) -> Any:
    return SimpleNamespace(
        guard=SimpleNamespace(conjuncts=(SimpleNamespace(sensor=sensor, low=low, high=high),))
    )


def test_first_episodes_under_the_condition_are_run_with_their_seeds() -> None:
    mutants = Mutants([neighbour()])
    found = beside(mutants, guard(7.0, 8.0))  # type: ignore[arg-type]
    assert [seed for _, seed in mutants.ran] == [FIRST + 2 * n for n in range(3, 3 + EPISODES)]
    assert (found.episodes, found.lost, len(found.held)) == (EPISODES, (), 1)
    assert (
        f"{3 + (EPISODES - 1) / 2:.4g} per episode instead of {3 + (EPISODES - 1) / 2:.4g} as recorded"
        in found.held[0]
    )


def test_only_episodes_in_which_the_condition_holds_are_run() -> None:
    mutants = Mutants([neighbour(holding=range(38, 40))])
    assert beside(mutants, guard(7.0, 8.0)).episodes == 2  # type: ignore[arg-type]
    assert [seed for _, seed in mutants.ran] == [FIRST + 76, FIRST + 78]


def test_condition_that_never_holds_runs_no_episode() -> None:
    mutants = Mutants([neighbour()])
    found = beside(mutants, guard(9.0, 10.0))  # type: ignore[arg-type]
    assert (mutants.ran, found.episodes, found.lost) == ([], 0, ())
    assert "the condition never holds there" in found.held[0]


def test_first_episodes_run_without_a_recorded_sensor() -> None:
    mutants = Mutants([neighbour(sensors=(Y,))])
    assert beside(mutants, guard(7.0, 8.0)).episodes == EPISODES  # type: ignore[arg-type]
    assert [seed for _, seed in mutants.ran] == [FIRST + 2 * n for n in range(EPISODES)]


@pytest.mark.parametrize(("change", "lost"), [(-0.5, False), (-0.51, True), (3.0, False)])
def test_mission_is_lost_if_its_loss_exceeds_the_margin(change: float, lost: bool) -> None:
    found = beside(Mutants([neighbour()], change), guard(7.0, 8.0))  # type: ignore[arg-type]
    assert bool(found.lost) is lost
    assert bool(found.held) is not lost


def test_newly_failing_mission_is_a_loss() -> None:
    found = beside(Mutants([neighbour()], 5.0, fails=4), guard(7.0, 8.0))  # type: ignore[arg-type]
    assert "1 of them now fail" in found.lost[0]


def test_no_further_test_is_run_after_a_loss() -> None:
    mutants = Mutants([neighbour(0), neighbour(1)], -9.0)
    found = beside(mutants, guard(7.0, 8.0))  # type: ignore[arg-type]
    assert {rollout for rollout, _ in mutants.ran} == {"rollout 0"}
    assert found.episodes == EPISODES


def test_limited_number_of_other_tests_runs() -> None:
    mutants = Mutants([neighbour(n) for n in range(MOST + 3)])
    found = beside(mutants, guard(7.0, 8.0))  # type: ignore[arg-type]
    assert len({rollout for rollout, _ in mutants.ran}) == MOST
    assert found.held[-1] == "3 more tests of the node were not run"
    assert found.episodes == MOST * EPISODES


def test_test_with_its_own_drift_is_compared_unrepaired() -> None:
    mutants = Mutants([neighbour(drift="mud")], -0.4)
    found = beside(mutants, guard(7.0, 8.0))  # type: ignore[arg-type]
    assert len(mutants.ran) == 2 * EPISODES
    assert "6.5 without the repair under the same drift" in found.held[0]


def test_permanent_drift_allows_losses_of_other_tests() -> None:
    found = beside(Mutants([neighbour()], -9.0, permanent=True), guard(7.0, 8.0))  # type: ignore[arg-type]
    assert (found.lost, "the old world, in which losses are allowed" in found.held[0]) == ((), True)
    under = beside(Mutants([neighbour(drift="mud")], -9.0, permanent=True), guard(7.0, 8.0))  # type: ignore[arg-type]
    assert under.lost


def test_tests_of_other_nodes_are_not_run() -> None:
    mutants = Mutants([neighbour(nodes=(Path("/project/other.py"),))])
    assert beside(mutants, guard(7.0, 8.0)).episodes == 0  # type: ignore[arg-type]
    assert mutants.ran == []
