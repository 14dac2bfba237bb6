"""Our own method on a task: record, compare, search, accept; then evaluate on held-out seeds."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from statistics import fmean
from typing import Any

from stage import Stage

from pytest_tarl.comparing import run_online
from pytest_tarl.errors import TarlError
from pytest_tarl.learning.fixture import Fixture
from pytest_tarl.options import Options
from pytest_tarl.recording import mean_flows, run_episodes, sarsa_tables, sound
from pytest_tarl.repairing.mutants import Mutants
from pytest_tarl.repairing.repair import repair
from pytest_tarl.repairing.request import Order
from pytest_tarl.rollout import EpisodePlan
from pytest_tarl.searching.accept import Outcome
from pytest_tarl.seeds import episode_seeds

HELD_OUT = 30  # number of held-out episodes of each world
JUDGED = 400  # number of held-out episodes of each world on which an accepted repair is judged
RESTORED = 0.95
Overlay = Mapping[Path, str]


def prepared(stage: Stage, seed: int, budget: int = Options.budget, search: str = "sweep") -> Order:
    """Record the task as designed and run it under its drift, as `--tarl-record` and `--tarl-online` do."""
    marked = stage.marked
    chosen = episode_seeds(seed, "offline", marked.episodes)
    offline = run_episodes(stage.rollout, chosen, None, stage.sites.members, quiet)
    tables = sarsa_tables(offline, mean_flows(offline.sample))
    fixture = Fixture(
        stage.test, seed, marked.sensors, stage.sites.lists, offline.topics, offline.sample, tables
    )
    plugged = ":" in search  # a plugged-in search is that of a peer, which changes only constants
    options = Options(mode="repair", seed=seed, budget=budget, searches=(search,), structure=not plugged)
    online = run_online(stage.rollout, fixture, marked, options, stage.sites, stage.drift, quiet)
    patches = stage.folder / ".tarl" / "patches"
    return Order(
        stage.rollout,
        stage.analysis,
        stage.folder,
        fixture,
        online,
        options,
        quiet,
        patches,
        world=marked.drifts[stage.drift],
        declared=marked.total_range,
    )


def ours(stage: Stage, seed: int, search: str = "sweep") -> dict[str, Any]:
    """Repair the task; return the rank of the right sites, the restored reward, and the cost."""
    order = prepared(stage, seed, search=search)
    slices = [culprit.site.id for culprit in order.comparison.culprits]
    outcome = repair(order)
    fixed = outcome.comparison.repair
    assert fixed is not None
    overlay: Overlay = {}
    if outcome.accepted is not None:
        overlay = Mutants(order).source(outcome.accepted.candidate)
    return {
        "ranked": [culprit.site.id for culprit in outcome.comparison.culprits],
        "slices": slices,
        "verdict": outcome.comparison.verdict.result,
        "accepted": fixed.accepted,
        "reason": fixed.reason,
        "guard": fixed.guard,
        "permanent": stage.permanent,
        "edits": [
            f"{edit.path}:{edit.line} {edit.what or f'{edit.code} → {edit.value:g}'}" for edit in fixed.edits
        ],
        "episodes": {"comparison": order.online.recorded.sample.episodes, **outcome.episodes},
        **judged(order, overlay if fixed.accepted else None),
    }


@dataclass(frozen=True)
class Seen:
    """The mean reward and the pass rate over the held-out seeds of a world."""

    mean: float
    passed: float


def judged(order: Order, overlay: Overlay | None) -> dict[str, Any]:
    """Evaluate a repair on held-out seeds in both worlds; if there is no repair, nothing is restored."""
    episodes = HELD_OUT if overlay is None else JUDGED
    designed = seen(order, None, {}, episodes)
    found: dict[str, Any] = {"offline": designed.mean}
    for name, drift in (("drifted", order.drift), ("nominal", None)):
        world = seen(order, drift, overlay or {}, episodes)
        found[name] = world.mean
        found[f"{name} passed"] = world.passed
        found[f"{name} restored"] = overlay is not None and world.mean >= designed.mean - (
            1 - RESTORED
        ) * abs(designed.mean)
    return found


def seen(order: Order, drift: str | None, overlay: Overlay, episodes: int) -> Seen:
    """Run the held-out episodes of one world."""
    chosen = episode_seeds(order.options.seed, "held out", episodes)
    runs = [_outcome(order, EpisodePlan(seed, drift, overlay)) for seed in chosen]
    return Seen(fmean(run.total for run in runs), fmean(run.passed for run in runs))


def _outcome(order: Order, episode: EpisodePlan) -> Outcome:
    """Run one episode; if the node ends before the episode, the reward is that of the worst recorded episode."""
    try:
        run = sound(order.rollout(episode))
    except TarlError:
        return Outcome(order.worst, passed=False)
    total = float(run.trace.reward.sum())
    return Outcome(min(total, order.worst) if run.crashed else total, run.passed)


def quiet(done: int, total: int, what: str) -> None:
    """Show no progress."""
