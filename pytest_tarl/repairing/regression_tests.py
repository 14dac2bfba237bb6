"""Regression tests: other recorded tests of a changed file must not lose reward in the designed world."""

from __future__ import annotations

import re
from collections.abc import Sequence, Set
from dataclasses import dataclass
from pathlib import Path
from statistics import fmean

from pytest_tarl.instrumentation.datafiles import is_data
from pytest_tarl.repairing.mutants import Mutants
from pytest_tarl.repairing.request import Neighbour
from pytest_tarl.searching import candidates
from pytest_tarl.searching.accept import Outcome
from pytest_tarl.searching.search import Candidate

MOST = 5  # maximum number of other tests to run
EPISODES = 8  # number of episodes per test; the first episodes in which the guard holds are chosen


@dataclass(frozen=True)
class Beside:
    """Results of other tests: sentences on tests that kept or lost reward, and the episodes run."""

    held: tuple[str, ...] = ()
    lost: tuple[str, ...] = ()
    episodes: int = 0


NOTHING_BESIDE = Beside()


def beside(mutants: Mutants, candidate: Candidate) -> Beside:
    """Run the recorded missions of other tests of the changed files, until a test loses reward. Raise RepairError."""
    changed = {path.resolve() for path in mutants.source(candidate)}
    concerned = [one for one in mutants.order.neighbours() if _uses(one, changed, mutants.order.root)]
    held: list[str] = []
    episodes = 0
    for neighbour in concerned[:MOST]:
        chosen = _chosen(neighbour, candidate)
        lost, told = _compared(mutants, neighbour, candidate, chosen)
        episodes += len(chosen)
        if lost:
            return Beside(tuple(held), (told,), episodes)
        held.append(told)
    if len(concerned) > MOST:
        held.append(f"{len(concerned) - MOST} more tests of the node were not run")
    return Beside(tuple(held), (), episodes)


def _uses(neighbour: Neighbour, changed: Set[Path], root: Path) -> bool:
    """Return whether a test depends on changed files: its nodes, or files that its nodes or code mention."""
    if changed & set(neighbour.nodes):
        return True
    texts = [root / neighbour.test.partition("::")[0], *neighbour.nodes]
    names = re.compile(
        "|".join(rf"\b{re.escape(path.name if is_data(path) else path.stem)}\b" for path in changed)
    )
    return any(path.is_file() and names.search(path.read_text("utf-8", "replace")) for path in texts)


def _chosen(neighbour: Neighbour, candidate: Candidate) -> Sequence[int]:
    """Return the indices of the recorded episodes to run: those in which the guard holds, if this is known."""
    fixture = neighbour.fixture
    if any(conjunct.sensor not in fixture.sensors for conjunct in candidate.guard.conjuncts):
        return range(min(EPISODES, fixture.sample.episodes))
    firing = candidates.firing_episodes(candidate.guard, fixture.sample, fixture.sensors)
    place = {seed: at for at, seed in enumerate(fixture.sample.seeds)}
    return [place[seed] for seed in firing[:EPISODES]]


def _compared(
    mutants: Mutants, neighbour: Neighbour, candidate: Candidate, chosen: Sequence[int]
) -> tuple[bool, str]:
    """Compare a test's missions with its recording; return whether they lose reward, and a sentence about it."""
    if not chosen:
        return False, f"{neighbour.test}: as recorded, because the condition never holds there"
    sample = neighbour.fixture.sample
    outcomes = _run(mutants, neighbour, candidate, chosen)
    if neighbour.drift is not None:
        before, what = (
            _run(mutants, neighbour, None, chosen),
            "without the repair under the same drift",
        )
    else:
        before = [Outcome(float(sample.total[at]), bool(sample.passed[at])) for at in chosen]
        what = "as recorded"
    failed = sum(not outcome.passed and usual.passed for outcome, usual in zip(outcomes, before, strict=True))
    now, usually = (fmean(outcome.total for outcome in world) for world in (outcomes, before))
    told = f"{neighbour.test}: {now:.4g} per episode instead of {usually:.4g} {what}, {len(chosen)} episodes"
    if failed:
        told += f", {failed} of them now fail"
    if mutants.order.permanent and neighbour.drift is None:
        return (
            False,
            f"{told}; it does not declare the drift, so it ran in the old world, in which losses are allowed",
        )
    return failed > 0 or now < usually - neighbour.margin, told


def _run(
    mutants: Mutants, neighbour: Neighbour, candidate: Candidate | None, chosen: Sequence[int]
) -> list[Outcome]:
    """Run some of the recorded episodes of another test again."""
    sample = neighbour.fixture.sample
    worst = float(sample.total.min())
    return [
        mutants.run_at(neighbour.rollout, worst, candidate, sample.seeds[at], neighbour.drift)
        for at in chosen
    ]
