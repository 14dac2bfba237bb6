"""`--tarl-repair`: search a mutation, find its guard, accept it on fresh seeds, write the patch."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from statistics import fmean, stdev
from typing import Any

from pytest_tarl import candidates, localize, seeds
from pytest_tarl.accept import LOOKS, Acceptance, Outcome, Reference, accept
from pytest_tarl.comparing import Online
from pytest_tarl.errors import RepairError
from pytest_tarl.fixture import Fixture
from pytest_tarl.model import Comparison, Edit, Guard, Reason, Repair, SearchTrace
from pytest_tarl.mutate import rewrite
from pytest_tarl.recording import Progress, sound
from pytest_tarl.rollout import EpisodePlan, Rollout
from pytest_tarl.search import BudgetSpentError, Candidate, EpsilonGreedy, Goal, Pair, Sweep, Trials, label
from pytest_tarl.settings import Options
from tarl_lint.api import Analysis
from tarl_lint.model import Operand

QUICK = 3                               # seeds on which a guard is looked at before it is tested on fresh ones
MOST_ACCEPTANCES = 5                    # candidates that are tested on fresh seeds


@dataclass(frozen=True)
class Accepted:
    """A repair that held: the candidate, and the episodes that show it."""

    candidate: Candidate
    acceptance: Acceptance


@dataclass
class RepairShop:
    """Everything that repairing one test under one drift needs, and what it has cost so far."""

    rollout: Rollout
    analysis: Analysis
    root: Path                          # what the analysis' paths are relative to
    fixture: Fixture
    online: Online
    options: Options
    progress: Progress
    spent: dict[str, int] = field(default_factory=lambda: {"search": 0, "acceptance": 0})
    tested: int = 0
    reason: Reason = "no operand helps"
    best: Candidate | None = None
    _mutants: dict[Candidate, Mapping[Path, str]] = field(default_factory=dict)

    @property
    def comparison(self) -> Comparison:
        """Return what the on-line run found."""
        return self.online.comparison

    @property
    def reference(self) -> Reference:
        """Return the off-line world that repairs are held against."""
        offline = self.fixture.sample
        return Reference(
            offline.total.tolist(), float(offline.passed.mean()), self.comparison.verdict.tolerance
        )

    def run(self, candidate: Candidate, seed: int, drift: str | None) -> Outcome:
        """Run one episode of a candidate. Raises RepairError when it cannot be written into the source."""
        run = sound(self.rollout(EpisodePlan(seed, drift, self.mutant(candidate))))
        return Outcome(float(run.trace.reward.sum()), run.passed)

    def mutant(self, candidate: Candidate) -> Mapping[Path, str]:
        """Return the candidate as source: path → text of every file that it changes."""
        if candidate not in self._mutants:
            texts = rewrite(self.analysis, candidate.mutations, candidate.guard, self.fixture.topics)
            self._mutants[candidate] = {self.root / path: text for path, text in texts.items()}
        return self._mutants[candidate]


def repair(shop: RepairShop) -> Comparison:
    """Search, guard, accept; return the comparison with culprits, curves and the repair in it."""
    comparison = shop.comparison
    worlds = (shop.fixture.sample, shop.online.recorded.sample)
    guards = candidates.candidate_guards(comparison.region, comparison.sensors, worlds)
    widest = candidates.widest(guards, worlds[1], comparison.sensors)
    accepted: Accepted | None = None
    searches: list[SearchTrace] = []
    effects: dict[str, list[OperandEffect]] = {}
    for method in shop.options.searches:
        trials = Trials(lambda candidate, seed: shop.run(candidate, seed, comparison.drift), shop.options.budget)
        for guard in dict.fromkeys((widest, candidates.ALWAYS)):
            strategy = _strategy(shop, method, guard, trials)
            found = _first_accepted(shop, strategy.candidates(), guards, wanted=accepted is None)
            effects = effects or strategy.effects()
            accepted = accepted or found
            if found is not None or trials.spent >= trials.budget:
                break
        searches.append(SearchTrace(method, tuple(trials.totals), tuple(trials.labels)))
        shop.spent["search"] += trials.spent
    return _concluded(shop, accepted, effects, searches)


def ranked_operands(analysis: Analysis, comparison: Comparison) -> tuple[Operand, ...]:
    """Return all operands of the analysed flows, those of the sites that the slices rank first in front."""
    rank = {culprit.site.id: i for i, culprit in enumerate(comparison.culprits)}
    steps = sorted(analysis.sites, key=lambda step: rank.get(str(step.site), len(rank)))
    return tuple(dict.fromkeys(operand for step in steps for operand in analysis.operands(step.site)))


def goal(online: Sequence[Pair], reference: Reference, loss: float) -> Goal:
    """Pick the on-line episodes that lost, worst last, and say what a mutation must reach on them."""
    spread = stdev(reference.totals) if len(reference.totals) > 1 else 0.0
    slack = max(reference.margin, 2 * spread, 0.1 * loss)
    near = reference.mean - slack
    lost = sorted((pair for pair in online if pair.total < near), key=lambda pair: -pair.total)
    enough = reference.mean - max(reference.margin, spread)
    return Goal(tuple(lost) or tuple(online), near, enough)


def _strategy(shop: RepairShop, method: str, guard: Guard, trials: Trials) -> Sweep | EpsilonGreedy:
    operands = ranked_operands(shop.analysis, shop.comparison)
    online = shop.online.recorded.sample
    pairs = [Pair(seed, total) for seed, total in zip(online.seeds, online.total.tolist(), strict=True)]
    aim = goal(pairs, shop.reference, shop.comparison.verdict.loss)
    if method == "sweep":
        return Sweep(operands, guard, trials, aim)
    fresh = seeds.episode_seeds(shop.options.seed, "search", trials.budget)
    return EpsilonGreedy(operands, guard, trials, aim, fresh, seeds.generator(shop.options.seed, method))


def _first_accepted(
    shop: RepairShop, found: Iterator[Candidate], guards: Sequence[Guard], *, wanted: bool
) -> Accepted | None:
    """Test confirmed candidates under their guards, in order, until one is accepted; only run them if not `wanted`."""
    try:
        for candidate in found:
            if not wanted:
                return None
            shop.best = shop.best or candidate
            for guard in guards:
                guarded = replace(candidate, guard=guard)
                accepted = _tested(shop, guarded)
                if accepted is not None:
                    return accepted
    except BudgetSpentError:
        shop.reason = "budget" if shop.best is None else shop.reason
    return None


def _tested(shop: RepairShop, candidate: Candidate) -> Accepted | None:
    """Look at the candidate on a few known seeds, then test it on fresh ones at α/2ᵏ."""
    if shop.tested >= MOST_ACCEPTANCES or not _promising(shop, candidate):
        return None
    shop.tested += 1
    drift = shop.comparison.drift
    fires = candidates.firing_episodes(candidate.guard, shop.fixture.sample, shop.comparison.sensors)
    outcome = accept(
        lambda seed: shop.run(candidate, seed, drift),
        (lambda seed: shop.run(candidate, seed, None)) if fires else None,
        seeds.episode_seeds(shop.options.seed, f"acceptance {shop.tested}", LOOKS[-1]),
        shop.reference,
        shop.options.alpha / 2**shop.tested,
    )
    shop.spent["acceptance"] += len(outcome.drifted) + len(outcome.nominal)
    if outcome.accepted:
        return Accepted(candidate, outcome)
    shop.reason = outcome.reason
    return None


def _promising(shop: RepairShop, candidate: Candidate) -> bool:
    """Tell whether the candidate holds on a few on-line episodes that lost and off-line ones in which it acts."""
    offline, online = shop.fixture.sample, shop.online.recorded.sample
    pairs = [Pair(seed, total) for seed, total in zip(online.seeds, online.total.tolist(), strict=True)]
    aim = goal(pairs, shop.reference, shop.comparison.verdict.loss)
    firing = candidates.firing_episodes(candidate.guard, offline, shop.comparison.sensors)
    known = dict(zip(offline.seeds, offline.total.tolist(), strict=True))
    slack = shop.reference.mean - aim.near
    worlds = (
        [(pair.seed, shop.comparison.drift, aim.near, "gain too small") for pair in aim.pairs[:QUICK]]
        + [(seed, None, known[seed] - slack, "nominal gets worse") for seed in firing[:QUICK]]
    )
    for seed, drift, least, reason in worlds:
        shop.spent["search"] += 1
        try:
            total = shop.run(candidate, seed, drift).total
        except RepairError:
            return False
        if total < least:
            shop.reason = "nominal gets worse" if drift is None else "gain too small"
            return False
    return True


def _concluded(
    shop: RepairShop,
    accepted: Accepted | None,
    effects: Mapping[str, list[OperandEffect]],
    searches: Sequence[SearchTrace],
) -> Comparison:
    comparison = shop.comparison
    ranked = [(culprit.site, culprit.score) for culprit in comparison.culprits] or _unranked(shop)
    chosen = accepted.candidate if accepted else shop.best
    repaired = [str(m.operand.site) for m in chosen.mutations] if chosen else []
    totals = dict(comparison.totals)
    if accepted:
        totals["repaired"] = tuple(outcome.total for outcome in accepted.acceptance.drifted)
        nominal = tuple(outcome.total for outcome in accepted.acceptance.nominal)
        totals["nominal_repaired"] = nominal or totals["offline"]
    return replace(
        comparison,
        culprits=localize.culprits(ranked, effects, repaired, comparison.verdict.loss),
        searches=tuple(searches),
        totals=totals,
        repair=_repair(shop, accepted),
    )
