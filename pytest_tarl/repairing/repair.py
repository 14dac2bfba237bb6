"""The whole repair: search, guard, accept, deliver."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace

from pytest_tarl import seeds
from pytest_tarl.learning import localize
from pytest_tarl.model import Comparison, Guard, OperandEffect, SearchTrace, SitePlace
from pytest_tarl.repairing.accepting import Accepted, Examiner
from pytest_tarl.repairing.delivering import delivered, withheld
from pytest_tarl.repairing.mutants import Mutants
from pytest_tarl.repairing.order import Order
from pytest_tarl.searching import candidates
from pytest_tarl.searching.accept import Outcome
from pytest_tarl.searching.epsilon_greedy import EpsilonGreedy
from pytest_tarl.searching.search import BudgetSpentError, Candidate, Strategy, Trials
from pytest_tarl.searching.sweep import Sweep
from tarl_lint.model import Operand

MOST_GUARDS = 3  # that a search runs under


@dataclass(frozen=True)
class Repaired:
    """How a repair ended: the comparison with culprits, curves and repair in it, what held, episodes by kind."""

    comparison: Comparison
    accepted: Accepted | None
    episodes: Mapping[str, int]


@dataclass
class _Findings:
    """What the searches have brought so far; effects are those of the first one that has any, by its name."""

    accepted: Accepted | None = None
    effects: Mapping[str, Sequence[OperandEffect]] | None = None
    method: str = ""
    curves: tuple[SearchTrace, ...] = ()
    episodes: int = 0


def repair(order: Order) -> Repaired:
    """Run the searches asked for; the first candidate that is accepted counts."""
    mutants = Mutants(order)
    hints = evidence(order)
    guards = candidates.candidate_guards(hints)
    examiner = Examiner(mutants, guards)
    found = _Findings()
    for method in order.options.searches:
        trials = _trials(mutants, method)
        strategy = _strategy(mutants, method, candidates.telling(guards, hints, MOST_GUARDS), trials)
        if found.accepted is None:
            found.accepted = examiner.first(strategy.candidates(), trials)
        else:
            _exhibit(strategy)
        if not found.effects:
            found.effects, found.method = strategy.effects(), method
        found.curves += (SearchTrace(method, tuple(trials.totals), tuple(trials.labels)),)
        found.episodes += trials.spent
    return _concluded(mutants, examiner, found)


def operands(order: Order) -> tuple[Operand, ...]:
    """Return all operands of the analysed flows, those of the sites that the slices rank first in front."""
    rank = {culprit.site.id: i for i, culprit in enumerate(order.comparison.culprits)}
    steps = sorted(order.analysis.sites, key=lambda step: rank.get(str(step.site), len(rank)))
    return tuple(dict.fromkeys(o for step in steps for o in order.analysis.operands(step.site)))


def evidence(order: Order) -> candidates.Evidence:
    """Return what guards can be read from."""
    comparison = order.comparison
    return candidates.Evidence(
        comparison.sensors,
        order.fixture.sample,
        order.online.recorded.sample,
        comparison.region,
        comparison.changes,
    )


def _trials(mutants: Mutants, method: str) -> Trials:
    order = mutants.order

    def run(candidate: Candidate, seed: int) -> Outcome:
        order.progress(trials.spent, trials.budget, method)
        return mutants.run(candidate, seed, order.drift)

    trials = Trials(run, order.options.budget)
    return trials


def _strategy(mutants: Mutants, method: str, guards: Sequence[Guard], trials: Trials) -> Strategy:
    order = mutants.order
    if method == "sweep":
        generator = seeds.generator(order.options.seed, method)
        return Sweep(operands(order), mutants.mutate, guards, trials, order.goal, generator)
    return EpsilonGreedy(
        operands(order),
        mutants.mutate,
        tuple(dict.fromkeys((guards[0], candidates.ALWAYS))),
        trials,
        order.goal,
        seeds.episode_seeds(order.options.seed, "search", EpsilonGreedy.episodes(trials.budget)),
        seeds.generator(order.options.seed, method),
    )


def _exhibit(strategy: Strategy) -> None:
    """Run a search for its curve only, up to its first candidate."""
    with suppress(BudgetSpentError):
        next(strategy.candidates(), None)


def _concluded(mutants: Mutants, examiner: Examiner, found: _Findings) -> Repaired:
    order, accepted = mutants.order, found.accepted
    chosen = accepted.candidate if accepted else examiner.refused.candidate
    totals = dict(order.comparison.totals)
    if accepted:
        totals["repaired"] = tuple(outcome.total for outcome in accepted.acceptance.drifted)
        nominal = tuple(outcome.total for outcome in accepted.acceptance.nominal)
        totals["nominal_repaired"] = nominal or totals["offline"]
    comparison = replace(
        order.comparison,
        culprits=localize.culprits(
            _ranked(order),
            found.effects or {},
            [str(mutation.operand.site) for mutation in chosen.mutations] if chosen else [],
            order.comparison.verdict.loss,
            found.method,
        ),
        searches=found.curves,
        totals=totals,
        repair=delivered(mutants, accepted, found.episodes, examiner.spent)
        if accepted
        else withheld(order, examiner.refused),
    )
    return Repaired(comparison, accepted, {"search": found.episodes, "acceptance": examiner.spent})


def _ranked(order: Order) -> list[tuple[SitePlace, float]]:
    """Return the sites as the slices rank them, then those that the recording did not know."""
    ranked = [(culprit.site, culprit.score) for culprit in order.comparison.culprits]
    known = {site.id for site, _ in ranked}
    for step in order.analysis.sites:
        if str(step.site) not in known:
            span = step.span
            place = SitePlace(str(step.site), span.path, span.line, step.code, step.dependence, step.role)
            ranked.append((place, 0.0))
    return ranked
