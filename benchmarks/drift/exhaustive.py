"""Find all right sites of the tasks by simulation, and write them into each task's answer.json.

    python benchmarks/drift/exhaustive.py [TASK ...] [--workers 2]

Every operand of every site takes every value of a fine grid, without a guard and under the guard that, as the task's
author knows, is true where the drift acts ("where"). A constant that occurs several times at a site is also changed at
all of them at once, and pairs of operands of a site are also changed together. A site is right if changing its operands
alone restores the drifted world to 95 % of the designed reward, over EPISODES seeds that nothing else uses. If no site
is right, all pairs of operands are tried. If a task has more than two culprits, each of them in turn is replaced by
every other operand, while the others keep the values that the author knows.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import cached_property
from itertools import chain, combinations, product
from math import log
from pathlib import Path
from statistics import fmean
from typing import Any

from stage import HERE, Stage, tasks_in, visit

from pytest_tarl.errors import RepairError, TarlError
from pytest_tarl.model import Conjunct, Guard
from pytest_tarl.patching.mutate import Mutation, is_integral, mutations
from pytest_tarl.patching.rewriting import rewrite
from pytest_tarl.recording import sound
from pytest_tarl.rollout import EpisodePlan
from pytest_tarl.seeds import episode_seeds
from tarl_lint.model import Operand

FINE = tuple(percent / 100 for percent in range(5, 100, 5))
FACTORS = (*sorted((*FINE, *(round(1 / factor, 3) for factor in FINE)), key=lambda f: abs(log(f))), 0.0, -1.0)
COARSE = (0.1, 0.25, 0.4, 0.55, 0.7, 0.85, 1.2, 1.5, 2.0, 2.75, 4.0, 8.0)
# number of repairs of the same sites after which the search for a repair that also works in the nominal world ends
SHOWN = 8
COARSEST = (0.35, 0.65, 1.5, 2.0, 3.0, 5.0)  # factors for all pairs of operands
EPISODES = 24
RESTORED = 0.95
SCREENED = 3  # a candidate that loses reward in one of the first SCREENED episodes is dropped
MOST_LOST = 2  # maximum number of episodes in which a candidate may lose reward

Change = tuple[Mutation, ...]


@dataclass(frozen=True)
class Found:
    """A candidate that restores the drifted world; `nominal` is its reward in the designed world."""

    change: Change
    guard: Guard
    drifted: float
    nominal: float


class World:
    """The two worlds of a task, and the reward of the unchanged node in each."""

    def __init__(self, stage: Stage) -> None:
        self.stage = stage
        self.seeds = episode_seeds(11, "exhaustive", EPISODES)
        runs = [stage.rollout(EpisodePlan(seed, None)) for seed in self.seeds]
        self.topics = runs[0].topics
        totals = [float(run.trace.reward.sum()) for run in runs]
        self.offline, self.least = fmean(totals), min(totals)
        self.floor = min(0.0, *(self._total(seed, self.stage.drift, {}) for seed in self.seeds[:8]))

    @cached_property
    def operands(self) -> list[Operand]:
        """Return all operands of the analysed flows."""
        analysis = self.stage.analysis
        return list(dict.fromkeys(o for step in analysis.sites for o in analysis.operands(step.site)))

    @cached_property
    def guards(self) -> list[Guard]:
        """Return the guards to try: no guard, and the guard that is true where the drift acts."""
        sensors = {sensor.name: sensor for sensor in self.stage.marked.sensors}
        where = [
            Conjunct(sensors[w["sensor"]], w.get("low", -float("inf")), w.get("high", float("inf")))
            for w in self.stage.answer["where"]
        ]
        return [Guard(), *([Guard(tuple(where))] if where else [])]

    def mutations(self, operand: Operand, factors: Sequence[float]) -> list[Mutation]:
        """Return the mutations of an operand by the given factors."""
        integral = is_integral(self.stage.analysis, operand)
        tried = [mutations(operand, factor, integral) for factor in factors]
        return list(dict.fromkeys(mutation for mutation in tried if mutation is not None))

    def tried(self, changes: Iterator[Change], guards: Sequence[Guard] | None = None) -> list[Found]:
        """Return the changes that restore the drifted world under one of the guards.

        Sites already known to be right are not tried again.
        """
        found: list[Found] = []
        for change in changes:
            shown = [one for one in found if _sites(one.change) == _sites(change)]
            if len(shown) >= SHOWN or any(one.nominal > 0 for one in shown):
                continue
            for guard in self.guards if guards is None else guards:
                drifted = self.earned(change, guard, self.stage.drift)
                if drifted is not None:
                    nominal = self.earned(change, guard, None)
                    found.append(Found(change, guard, drifted, -1.0 if nominal is None else nominal))
        return found

    def earned(self, change: Change, guard: Guard, drift: str | None) -> float | None:
        """Return the mean reward of a change if it reaches 95 % of the designed reward; otherwise None."""
        try:
            texts = rewrite(self.stage.analysis, change, guard, self.topics)
        except RepairError:
            return None
        overlay = {self.stage.folder / path: text for path, text in texts.items()}
        totals: list[float] = []
        goal = RESTORED * self.offline
        for seed in self.seeds:
            totals.append(self._total(seed, drift, overlay))
            lost = sum(total < min(goal, self.least) - 0.1 * abs(self.offline) for total in totals)
            if lost > (0 if len(totals) <= SCREENED else MOST_LOST):
                return None
        mean = fmean(totals)
        return mean if mean >= goal else None

    def _total(self, seed: int, drift: str | None, overlay: Any) -> float:
        try:
            run = sound(self.stage.rollout(EpisodePlan(seed, drift, overlay)))
        except TarlError:
            return -1e3
        return -1e3 if run.crashed else float(run.trace.reward.sum())


def singles(world: World) -> Iterator[Change]:
    """Yield every change to one operand, and every joint change to equal operands of a site."""
    of_site: dict[Any, list[Operand]] = {}
    for operand in world.operands:
        of_site.setdefault(operand.site, []).append(operand)
        yield from ((mutation,) for mutation in world.mutations(operand, FACTORS))
    for operands in of_site.values():
        for code in dict.fromkeys(operand.code for operand in operands):
            alike = [operand for operand in operands if operand.code == code]
            if len(alike) > 1:
                for factor in FACTORS:
                    together = [world.mutations(operand, (factor,)) for operand in alike]
                    yield tuple(mutation for one in together for mutation in one)


def of_one_site(world: World) -> Iterator[Change]:
    """Yield every joint change to two operands of the same site."""
    for site in dict.fromkeys(operand.site for operand in world.operands):
        yield from pairs(world, [operand for operand in world.operands if operand.site == site], COARSE)


def pairs(world: World, operands: Sequence[Operand], factors: Sequence[float]) -> Iterator[Change]:
    """Yield every joint change to two operands."""
    for one, other in combinations(operands, 2):
        yield from product(world.mutations(one, factors), world.mutations(other, factors))


def replaced(world: World, known: Change) -> Iterator[Change]:
    """Yield variants of a known repair: each part in turn is replaced by each mutation of each other operand."""
    for part in known:
        rest = tuple(mutation for mutation in known if mutation != part)
        taken = {mutation.operand for mutation in rest}
        for operand in world.operands:
            if operand not in taken:
                yield from ((*rest, mutation) for mutation in world.mutations(operand, FACTORS))


def known(world: World) -> Change:
    """Return the repair that the task's author knows."""
    chosen = []
    for text, code, factor in world.stage.answer["known"]:
        (operand,) = [o for o in world.operands if o.code == code and text in str(o.site)][:1]
        chosen += world.mutations(operand, (factor,))
    return tuple(chosen)


def answered(stage: Stage) -> dict[str, Any]:
    """Return the answer of a task: the entries of its author, and those found by simulation."""
    world = World(stage)
    found = world.tried(chain(singles(world), of_one_site(world)))
    how = "one site"
    culprits = len(stage.answer["known"])
    if not found and culprits == 2:
        how, found = "two sites", world.tried(pairs(world, world.operands, COARSEST), world.guards[-1:])
    elif not found and culprits > 2:
        how, found = "substitution", world.tried(replaced(world, known(world)))
    sets = _minimal({_sites(one.change) for one in found})
    return {
        **{name: stage.answer[name] for name in ("about", "known", "where")},
        "offline": round(world.offline, 3),
        "sites": len(stage.analysis.sites),
        "operands": len(world.operands),
        "how": how,
        "repairable": any(one.nominal > 0 for one in found),
        "right": [list(sites) for sites in sets],
        "evidence": [_evidence(sites, found) for sites in sets],
    }


def _sites(change: Change) -> tuple[str, ...]:
    return tuple(sorted({str(mutation.operand.site) for mutation in change}))


def _minimal(sets: set[tuple[str, ...]]) -> list[tuple[str, ...]]:
    return sorted(one for one in sets if not any(set(other) < set(one) for other in sets))


def _evidence(sites: tuple[str, ...], found: Sequence[Found]) -> dict[str, Any]:
    """Return the best repair of a set of sites; repairs that work in both worlds come first."""
    of_sites = [one for one in found if _sites(one.change) == sites]
    best = max(of_sites, key=lambda one: (one.nominal > 0, one.drifted))
    return {
        "edits": [[mutation.operand.code, mutation.value] for mutation in best.change],
        "guarded": bool(best.guard.conjuncts),
        "drifted": round(best.drifted, 3),
        "nominal": round(best.nominal, 3) if best.nominal > 0 else None,
    }


def main() -> None:
    """Write the answers of the given tasks, or of all tasks, each in its own process."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else "")
    parser.add_argument("tasks", nargs="*")
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--folder", type=Path, default=HERE, help="folder of the tasks")
    parser.add_argument("--here", action="store_true", help="answer a single task, in this process")
    arguments = parser.parse_args()
    home = arguments.folder.resolve()
    tasks = arguments.tasks or tasks_in(home)
    if arguments.here:
        answer = visit(tasks[0], answered, home=home)
        (home / tasks[0] / "answer.json").write_text(json.dumps(answer, indent=1, ensure_ascii=False) + "\n")
        print(json.dumps(answer, indent=1, ensure_ascii=False))
        return
    with ThreadPoolExecutor(arguments.workers) as pool:
        commands = [[sys.executable, __file__, task, "--here", "--folder", str(home)] for task in tasks]
        for done in pool.map(lambda command: subprocess.run(command, check=False), commands):
            if done.returncode:
                sys.exit(done.returncode)


if __name__ == "__main__":
    main()
