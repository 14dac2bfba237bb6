"""Simulated machines with drifts in physical units: the base of the sets of worlds, and the command that prints them.

A machine is a mission with the ranges of its drifts, and with the success rate and tolerance that a tester would
choose. An episode's noise depends only on its seed, as in a test that uses `tarl.rng`.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from statistics import fmean
from typing import Any

import numpy as np
from stress_worlds import finished

from pytest_tarl.designation import Designation
from pytest_tarl.rollout import Deferred, EpisodePlan, EpisodeRun, Pending
from pytest_tarl.seeds import generator
from pytest_tarl.spaces import Choice, Point, Space, Span, nominal

Mission = Callable[..., tuple[bool, float]]
GRAVITY = 9.81  # m/s²


@dataclass(frozen=True)
class Machine:
    """A mission with the ranges of its drifts, and the test's marker arguments."""

    mission: Mission
    directions: Mapping[str, Span | Choice]
    min_success: float
    tolerance: float

    workers = 1

    @property
    def space(self) -> Space:
        """Return the space of drifts."""
        return Space(self.directions, {})

    @property
    def marked(self) -> Designation:
        """Return the marker arguments."""
        return Designation((), (), min_success=self.min_success, tolerance=self.tolerance)

    def run(self, seed: int, point: Point) -> tuple[bool, float]:
        """Return whether the mission with this seed passes at a point, and its reward."""
        return self.mission(generator(seed, "world"), **self.space.world(point))

    def __call__(self, plan: EpisodePlan) -> EpisodeRun:
        """Run one episode."""
        assert plan.point is not None
        return finished(plan, *self.run(plan.seed, plan.point))

    def begin(self, plan: EpisodePlan) -> Pending:
        """Return an episode that runs when its result is requested."""
        return Deferred(self, plan)


def clipped(value: float, limit: float) -> float:
    """Return the value limited to ±`limit`."""
    return max(-limit, min(limit, value))


def rates(machine: Machine, point: Point, episodes: int) -> tuple[float, float]:
    """Return the success rate and the mean reward at a point."""
    runs = [machine.run(seed, point) for seed in range(episodes)]
    return fmean(passed for passed, _ in runs), fmean(total for _, total in runs)


def fails(machine: Machine, usual: float, found: tuple[float, float]) -> bool:
    """Return whether rates are worse than the marker allows; `usual` is the nominal reward."""
    return found[0] < machine.min_success or found[1] < usual - machine.tolerance


def _ends(extent: Span | Choice) -> list[float]:
    """Return the ends of a range, or the indices of all options except the nominal one."""
    every = range(len(extent.options)) if isinstance(extent, Choice) else (extent.low, extent.high)
    return [float(end) for end in every if end != nominal(extent)]


def _drawn(extent: Span | Choice, draws: np.random.Generator) -> float:
    """Return a random value of a range, or the index of a random option."""
    if isinstance(extent, Choice):
        return float(draws.integers(len(extent.options)))
    return float(draws.uniform(extent.low, extent.high))


def told(name: str, machine: Machine, drifts: int = 400, episodes: int = 40) -> str:
    """Return a line on a machine: results at nominal, at the ends of each range, and for random drifts."""
    usual = rates(machine, machine.space.nominal, 1000)
    ends: dict[str, Any] = {}
    for direction, extent in machine.directions.items():
        for end in _ends(extent):
            there = {**machine.space.nominal, direction: end}
            ends[f"{direction}={end:g}"] = "{:.2f}, {:.2f}".format(*rates(machine, there, 200))
    draws = np.random.default_rng(5)
    drawn = [
        {way: _drawn(extent, draws) for way, extent in machine.directions.items()} for _ in range(drifts)
    ]
    failing = fmean(fails(machine, usual[1], rates(machine, point, episodes)) for point in drawn)
    return f"{name}: nominal {usual[0]:.3f}, {usual[1]:.2f}; of random drifts {failing:.0%} fail; {ends}"


def command(machines: Mapping[str, Machine]) -> None:
    """Print, for each machine, how safe nominal is, and how many random drifts fail."""
    parser = argparse.ArgumentParser(description=command.__doc__)
    parser.add_argument("machines", nargs="*", metavar="MACHINE", help="default: all")
    parser.add_argument("--drifts", type=int, default=400, help="random drifts of each machine")
    arguments = parser.parse_args()
    for chosen in arguments.machines or machines:
        print(told(chosen, machines[chosen], arguments.drifts), flush=True)
