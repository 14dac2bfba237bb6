"""`--tarl-repair`: search a mutation, find its guard, accept it on fresh seeds, write the patch."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from statistics import fmean, stdev

from pytest_tarl import seeds
from pytest_tarl.comparing import Online
from pytest_tarl.errors import RepairError
from pytest_tarl.learning import localize
from pytest_tarl.learning.fixture import Fixture
from pytest_tarl.model import Comparison, Edit, Guard, OperandEffect, Reason, Repair, SearchTrace, SitePlace
from pytest_tarl.patching import patch
from pytest_tarl.patching.mutate import Mutation, guard_text, is_integral, mutations, rewrite
from pytest_tarl.recording import Progress, sound
from pytest_tarl.rollout import EpisodePlan, Rollout
from pytest_tarl.searching import candidates
from pytest_tarl.searching.accept import LOOKS, Acceptance, Outcome, Reference, accept
from pytest_tarl.searching.epsilon_greedy import EpsilonGreedy
from pytest_tarl.searching.search import (
    BudgetSpentError,
    Candidate,
    Goal,
    Pair,
    Strategy,
    Trials,
    effective_value,
)
from pytest_tarl.searching.sweep import Sweep
from pytest_tarl.settings import Options
from tarl_lint.api import Analysis
from tarl_lint.model import Operand

QUICK = 3  # seeds on which a guard is looked at before it is tested on fresh ones
MOST_GUARDS = 3  # that a search runs under
MOST_ACCEPTANCES = 5  # candidates that are tested on fresh seeds


@dataclass(frozen=True)
class Accepted:
    """A repair that held: the candidate, and the episodes that show it."""

    candidate: Candidate
    acceptance: Acceptance


@dataclass(frozen=True)
class Repaired:
    """How a repair ended: the comparison with culprits, curves and repair in it, and what was accepted."""

    comparison: Comparison
    accepted: Accepted | None


@dataclass
class RepairShop:
    """Everything that repairing one test under one drift needs, and what it has cost so far."""

    rollout: Rollout
    analysis: Analysis
    root: Path  # what the analysis' paths are relative to
    fixture: Fixture
    online: Online
    options: Options
    progress: Progress
    patches: Path  # the folder that patches are written to
    spent: dict[str, int] = field(default_factory=lambda: {"search": 0, "acceptance": 0})
    tested: int = 0
    reason: Reason = "no operand helps"
    best: Candidate | None = None
    _mutants: dict[Candidate, Mapping[Path, str]] = field(default_factory=dict)

    @property
    def comparison(self) -> Comparison:
        """Return what the on-line run found."""
        return self.online.comparison

    @cached_property
    def reference(self) -> Reference:
        """Return the off-line world that repairs are held against."""
        offline = self.fixture.sample
        return Reference(
            offline.total.tolist(), float(offline.passed.mean()), self.comparison.verdict.tolerance
        )

    @cached_property
    def goal(self) -> Goal:
        """Return what the search is after."""
        online = self.online.recorded.sample
        pairs = [Pair(seed, total) for seed, total in zip(online.seeds, online.total.tolist(), strict=True)]
        return goal(pairs, self.reference, self.comparison.verdict.loss)

    @cached_property
    def operands(self) -> tuple[Operand, ...]:
        """Return all operands of the analysed flows, those of the sites that the slices rank first in front."""
        rank = {culprit.site.id: i for i, culprit in enumerate(self.comparison.culprits)}
        steps = sorted(self.analysis.sites, key=lambda step: rank.get(str(step.site), len(rank)))
        return tuple(dict.fromkeys(o for step in steps for o in self.analysis.operands(step.site)))

    def mutate(self, operand: Operand, factor: float) -> Mutation | None:
        """Return one sweep step of an operand."""
        return mutations(operand, factor, is_integral(self.analysis, operand))

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


def repair(shop: RepairShop) -> Repaired:
    """Search, guard, accept."""
    comparison = shop.comparison
    evidence = candidates.Evidence(
        comparison.sensors,
        shop.fixture.sample,
        shop.online.recorded.sample,
        comparison.region,
        comparison.changes,
    )
    guards = candidates.candidate_guards(evidence)
    telling = candidates.telling(guards, evidence, MOST_GUARDS)
    accepted: Accepted | None = None
    searches: list[SearchTrace] = []
    effects: dict[str, list[OperandEffect]] = {}
    for method in shop.options.searches:
        trials = Trials(
            lambda candidate, seed: shop.run(candidate, seed, comparison.drift), shop.options.budget
        )
        strategy = _strategy(shop, method, telling, trials)
        found = _first_accepted(shop, strategy.candidates(), guards, wanted=accepted is None)
        effects = effects or strategy.effects()
        accepted = accepted or found
        searches.append(SearchTrace(method, tuple(trials.totals), tuple(trials.labels)))
        shop.spent["search"] += trials.spent
    return Repaired(_concluded(shop, accepted, effects, searches), accepted)


def goal(online: Sequence[Pair], reference: Reference, loss: float) -> Goal:
    """Pick the on-line episodes that lost, worst last, and say what a mutation must reach on them."""
    spread = stdev(reference.totals) if len(reference.totals) > 1 else 0.0
    slack = max(reference.margin, 2 * spread, 0.1 * loss)
    near = reference.mean - slack
    lost = sorted((pair for pair in online if pair.total < near), key=lambda pair: -pair.total)
    enough = reference.mean - max(reference.margin, spread)
    return Goal(tuple(lost) or tuple(online), near, enough)


def _strategy(shop: RepairShop, method: str, guards: Sequence[Guard], trials: Trials) -> Strategy:
    if method == "sweep":
        return Sweep(shop.operands, shop.mutate, guards, trials, shop.goal)
    fresh = seeds.episode_seeds(shop.options.seed, "search", EpsilonGreedy.episodes(trials.budget))
    return EpsilonGreedy(
        shop.operands,
        shop.mutate,
        tuple(dict.fromkeys((guards[0], candidates.ALWAYS))),
        trials,
        shop.goal,
        fresh,
        seeds.generator(shop.options.seed, method),
    )


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
    aim, offline = shop.goal, shop.fixture.sample
    firing = candidates.firing_episodes(candidate.guard, offline, shop.comparison.sensors)
    known = dict(zip(offline.seeds, offline.total.tolist(), strict=True))
    slack = shop.reference.mean - aim.near
    looks: list[tuple[int, str | None, float, Reason]] = [
        *((pair.seed, shop.comparison.drift, aim.near, "gain too small") for pair in aim.pairs[:QUICK]),
        *((seed, None, known[seed] - slack, "nominal gets worse") for seed in firing[:QUICK]),
    ]
    for seed, drift, least, reason in looks:
        shop.spent["search"] += 1
        try:
            total = shop.run(candidate, seed, drift).total
        except RepairError:
            return False
        if total < least:
            shop.reason = reason
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


def _unranked(shop: RepairShop) -> list[tuple[SitePlace, float]]:
    """Return the sites as they stand, where no slice ranks them."""
    return [
        (
            SitePlace(str(step.site), step.span.path, step.span.line, step.code, step.dependence, step.role),
            0.0,
        )
        for step in shop.analysis.sites
    ]


def _repair(shop: RepairShop, accepted: Accepted | None) -> Repair:
    """Write the patch of an accepted repair; otherwise tell the best candidate and why it was not."""
    candidate = accepted.candidate if accepted else shop.best
    if candidate is None:
        return Repair(False, "", (), reason=shop.reason)
    guard = guard_text(candidate.guard, shop.analysis, candidate.mutations, shop.fixture.topics)
    edits = tuple(_edit(mutation) for mutation in candidate.mutations)
    if accepted is None:
        return Repair(False, guard, edits, reason=shop.reason)
    changed = shop.mutant(candidate)
    originals = {path: path.read_bytes() for path in changed}
    diff = patch.unified_diff(originals, changed, shop.root, _evidence(shop, accepted, guard))
    written = patch.write(diff, shop.patches, shop.fixture.test, shop.comparison.drift)
    return Repair(True, guard, edits, patch.readable(diff), written.relative_to(shop.root).as_posix())


def _edit(mutation: Mutation) -> Edit:
    operand = mutation.operand
    value = effective_value(mutation)
    return Edit(operand.span.path, operand.span.line, operand.code, value, operand.value is None)


def _evidence(shop: RepairShop, accepted: Accepted, guard: str) -> list[str]:
    """Return what the patch's header tells: test, drift, seed, rewards before and after, episodes."""
    totals = shop.comparison.totals
    acceptance = accepted.acceptance
    repaired = [outcome.total for outcome in acceptance.drifted]
    nominal = [outcome.total for outcome in acceptance.nominal]
    lines = [
        f"Repair of {shop.fixture.test} under the drift {shop.comparison.drift or 'on-line'}, seed {shop.options.seed}",
        f"when: {guard or 'always'}",
        (
            f"reward per episode: off-line {fmean(totals['offline']):.4g}, on-line {fmean(totals['online']):.4g}, "
            f"repaired {fmean(repaired):.4g} ({len(repaired)} fresh episodes)"
        ),
        f"designed world: {fmean(nominal):.4g} ({len(nominal)} fresh episodes)"
        if nominal
        else "designed world: the guard never holds there",
    ]
    return [*lines, f"episodes spent: search {shop.spent['search']}, acceptance {shop.spent['acceptance']}"]
