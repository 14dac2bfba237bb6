"""Unrepaired missions recorded in both worlds with the same seed, and their symptoms."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from types import MappingProxyType

import numpy as np

from pytest_tarl.errors import TarlError
from pytest_tarl.instrumentation.sites import plan
from pytest_tarl.instrumentation.trace import Trace
from pytest_tarl.recording import sound
from pytest_tarl.repairing.request import Order
from pytest_tarl.rollout import EpisodePlan
from pytest_tarl.searching.search import BudgetSpentError, Trials
from pytest_tarl.sensors import Cell, Sensor
from pytest_tarl.symptoms.series import Pair, Series
from pytest_tarl.symptoms.symptoms import SYMPTOMS

NOTHING: Mapping[Path, str] = MappingProxyType({})
PAIRS = 2  # number of seeds; each costs an episode in both worlds

Recorded = tuple[Trace, Trace]  # the designed and the drifted mission of a seed


@dataclass(frozen=True)
class Signs:
    """The symptoms of mission pairs: their strength for each site id, and the sensor cells of each step.

    Steps before the first message have no cell. The longer mission of a pair is cut, so that both have the same number
    of steps. `steady` has the ids of the statements whose value never varied within a mission.
    """

    strengths: Mapping[str, Mapping[str, float]] = field(default_factory=dict)
    cells: tuple[tuple[tuple[Cell, ...], tuple[Cell, ...]], ...] = ()
    steady: frozenset[str] = frozenset()

    def strength(self, site: str, symptoms: Sequence[str]) -> float:
        """Return the strength of the strongest of some symptoms at a site."""
        found = self.strengths.get(site, {})
        return max((found.get(one, 0.0) for one in symptoms), default=0.0)

    def overlap(self, order: Order, sensor: Sensor) -> float:
        """Return the share of steps that are in the same bins of a sensor in both worlds; 0 if nothing is known.

        Only steps that both missions of a pair reached count, because a mission that ends early visits fewer bins.
        """
        at = [one.name for one in order.comparison.sensors].index(sensor.name)
        counts = [Counter(cell[at] for pair in self.cells for cell in pair[world]) for world in (0, 1)]
        steps = [sum(one.values()) for one in counts]
        if not all(steps):
            return 0.0
        return sum(min(counts[0][one] / steps[0], counts[1][one] / steps[1]) for one in counts[0])


NO_SIGNS = Signs()


def mission_pairs(order: Order, trials: Trials) -> tuple[Recorded, ...]:
    """Record and charge `PAIRS` mission pairs. Return none if the budget is spent or a mission cannot run."""
    if order.drift is None:
        return ()
    seeds = [pair.seed for pair in order.goal.pairs[:PAIRS]]
    try:
        return tuple(_pair(order, trials, seed) for seed in seeds)
    except (BudgetSpentError, TarlError):
        return ()


def signs(order: Order, pairs: Sequence[Recorded]) -> Signs:
    """Return the symptoms of mission pairs."""
    if not pairs:
        return NO_SIGNS
    return Signs(dict(_strengths(order, pairs)), tuple(map(_cells, pairs)), frozenset(_steady(order, pairs)))


def recorded(order: Order, seed: int, drift: str | None, overlay: Mapping[Path, str] = NOTHING) -> Trace:
    """Run a mission, perhaps with changed files, and return the values of its statements. Raise TarlError."""
    return sound(order.rollout(EpisodePlan(seed, drift, overlay, record=True, signed=True))).trace


def _pair(order: Order, trials: Trials, seed: int) -> Recorded:
    """Run both missions of a seed; charge them to the budget. Raise BudgetSpentError and TarlError."""
    found = []
    for drift in (None, order.drift):
        trials.charge()
        found.append(recorded(order, seed, drift))
    return found[0], found[1]


def _strengths(order: Order, recorded: Sequence[Recorded]) -> Iterator[tuple[str, Mapping[str, float]]]:
    for number, place in enumerate(plan(order.analysis).places):
        pairs = [Pair(series(one, number), series(other, number)) for one, other in recorded]
        if place.role != "publish" and all(pair.drifted.values.size for pair in pairs):
            yield place.id, {name: symptom(pairs) for name, symptom in SYMPTOMS.items()}


def _steady(order: Order, recorded: Sequence[Recorded]) -> Iterator[str]:
    """Yield the ids of statements that have a value in each designed mission and never vary within a mission."""
    for number, place in enumerate(plan(order.analysis).places):
        values = [series(trace, number).values for pair in recorded for trace in pair]
        same = all(one.min() == one.max() for one in values if one.size)
        if same and place.role != "publish" and all(one.size for one in values[::2]):
            yield place.id


def series(trace: Trace, number: int) -> Series:
    """Return the values of a statement in a mission; `number` identifies the statement."""
    here = trace.site == number
    return Series(trace.flow[here], trace.event_step[here], trace.reward)


def _cells(recorded: Recorded) -> tuple[tuple[Cell, ...], tuple[Cell, ...]]:
    steps = min(trace.steps for trace in recorded)
    designed, drifted = (
        tuple(trace.cells[one] for one in np.asarray(trace.step_cell[:steps]).tolist() if one >= 0)
        for trace in recorded
    )
    return designed, drifted
