"""Run a whole repair: search, choose a guard, accept and deliver."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import partial as partial_call

from pytest_tarl.learning import localize
from pytest_tarl.learning.judgements import with_worlds
from pytest_tarl.model import Comparison, FormulaRow, Guarantee, Guard, OperandEffect, SearchTrace, SitePlace
from pytest_tarl.repairing import strategies
from pytest_tarl.repairing.accepting import Accepted, Examiner
from pytest_tarl.repairing.budget import Purse
from pytest_tarl.repairing.confirmed_effects import gaining, with_confirmed
from pytest_tarl.repairing.delivering import attempts, delivered, partial, withheld
from pytest_tarl.repairing.early import Early
from pytest_tarl.repairing.enriching import enriched
from pytest_tarl.repairing.exceeding import exceeding
from pytest_tarl.repairing.following import following, proportional
from pytest_tarl.repairing.guaranteeing import guaranteed
from pytest_tarl.repairing.incumbent import Watch
from pytest_tarl.repairing.ledger import Refused
from pytest_tarl.repairing.mission_pairs import NO_SIGNS
from pytest_tarl.repairing.mutants import Mutants
from pytest_tarl.repairing.partial import best
from pytest_tarl.repairing.ranges import Ranged, bands_in_words, fits_a_part, repaired_sizes
from pytest_tarl.repairing.ranking_confidence import ranking_confidence
from pytest_tarl.repairing.request import Order
from pytest_tarl.repairing.reviewing import remarks
from pytest_tarl.repairing.scaled_commands import scaled_command
from pytest_tarl.repairing.structural import Structures
from pytest_tarl.repairing.unsearched_modules import unnamed_modules
from pytest_tarl.searching import candidates
from pytest_tarl.searching.attempts import Attempts
from pytest_tarl.searching.constants_first import constants_first
from pytest_tarl.searching.ranking import Ranking
from pytest_tarl.searching.search import BudgetSpentError, label
from pytest_tarl.searching.strategy import Strategy
from pytest_tarl.searching.suggestions import Suggestions
from pytest_tarl.searching.sweep import Sweep

CONSTANTS = 2 / 3  # share of the budget for the search of constants; structural changes get the rest
RESERVE = 1 / 6  # share of the budget that is added to the search of constants if a candidate has gained much
# share of the last phase's episodes that is reserved for examining confirmed candidates: without episodes left for
# choosing its condition, a candidate cannot be accepted
EXAMINING = 0.1
NAMED_FROM = 3  # a note says that a candidate works in a part of a range only after this number of episodes


@dataclass(frozen=True)
class Repaired:
    """The result: the comparison with suspect sites, curves and repair; the accepted candidate; the episode counts."""

    comparison: Comparison
    accepted: Accepted | None
    episodes: Mapping[str, int]
    interrupted: bool = False


@dataclass
class _Findings:
    """Results of the searches so far. `method` is the name of the first search that found any `effects`."""

    accepted: Accepted | None = None
    effects: Mapping[str, Sequence[OperandEffect]] | None = None
    method: str = ""
    curves: tuple[SearchTrace, ...] = ()
    interrupted: bool = False
    late: bool = False  # whether the search reached its time limit
    episodes: int = 0
    ranking: Ranking | None = None  # None unless all sites were ranked
    structural: Mapping[str, Sequence[OperandEffect]] | None = None  # gains of structural changes
    structure: int = 0  # number of episodes spent on structural changes; included in `episodes`
    early: Early | None = None  # the structural changes tried within the last search
    constants: Attempts | None = None  # the changes of constants that the last sweep tried

    def take(self, purse: Purse) -> None:
        """Add the episodes that a budget spent."""
        self.episodes += purse.spent
        self.late = self.late or purse.late


def repair(order: Order) -> Repaired:
    """Run the requested searches; the first accepted candidate is the repair. Raise RepairError."""
    mutants, found = Mutants(order), _Findings()
    purse = Purse(order.options.budget, order.options.seconds)
    _enrich(mutants, purse)
    hints = strategies.evidence(order)
    guards = (candidates.ALWAYS,) if order.permanent else candidates.candidate_guards(hints)
    searched = candidates.telling(guards, hints, strategies.MOST_GUARDS)
    examiner = Examiner(mutants, guards)
    watch = Watch(mutants.order)
    for number, method in enumerate(order.options.searches):
        if number:
            found.take(purse)
            purse = Purse(order.options.budget, order.options.seconds)
        _search(mutants, method, searched, examiner, purse, found, watch)
        if found.interrupted:
            break
    open_end = found.accepted is None and not found.interrupted
    if open_end and order.options.structure:
        _restructure(mutants, examiner, found, watch, searched, purse)
    found.take(purse)
    if order.options.localize == "full" and not found.interrupted:
        _rank(mutants, found, searched[0], watch)
    return _concluded(mutants, examiner, found, watch)


def _enrich(mutants: Mutants, purse: Purse) -> None:
    """If few missions fail, search for more that fail."""
    trials = purse.phase(mutants, "missions that fail", Watch(mutants.order))
    goal = enriched(mutants, trials)
    purse.settle(trials)
    mutants.order = replace(mutants.order, searched=goal)


def _search(
    mutants: Mutants,
    method: str,
    searched: Sequence[Guard],
    examiner: Examiner,
    purse: Purse,
    found: _Findings,
    watch: Watch,
) -> None:
    """Run one search; after an accepted repair, only for its curve in the report."""
    share = CONSTANTS if mutants.order.options.structure and method == "sweep" else 1.0
    trials = purse.phase(mutants, method, watch, share)
    if share < 1.0:
        trials.reserve, trials.worth = round(RESERVE * (purse.episodes - purse.spent)), mutants.order.goal
    first = found.accepted is None
    early = Early(mutants.order, _chief(searched), trials)
    suggestions = Suggestions(
        measured=early.measured,
        reached=partial_call(early.reached, mutants),
        entered=partial_call(early.entered, mutants),
    )
    if share < 1.0:
        suggestions = replace(
            suggestions,
            interlude=early.candidates,
            due=early.due,
            corrections=early.before_extreme,
            following=partial_call(following, mutants.order),
            proportional=partial_call(proportional, mutants.order),
            scaled=lambda one: scaled_command(mutants.order.analysis, one),
        )
    strategy = strategies.strategy(mutants, method, searched, trials, suggestions)
    try:
        if found.accepted is None:
            found.accepted = examiner.first(strategy.candidates(), trials)
        else:
            _exhibit(strategy)
    except KeyboardInterrupt:
        found.interrupted = True
    if isinstance(strategy, Sweep):
        found.constants = strategy.attempts
    if first and found.accepted is not None and early.waiting and _structural(found.accepted):
        found.effects, found.method = early.effects() or strategy.effects(), "structure"
        found.structure = early.spent
    elif not found.effects:
        found.effects, found.method = strategy.effects(), method
    found.early = early
    found.structural = gaining(found.structural or {}, early.effects())
    found.curves += (SearchTrace(method, tuple(trials.totals), tuple(trials.labels)),)
    purse.settle(trials)


def _restructure(
    mutants: Mutants,
    examiner: Examiner,
    found: _Findings,
    watch: Watch,
    searched: Sequence[Guard],
    purse: Purse,
) -> None:
    """Spend the remaining episodes on structural changes, because no change of constants was accepted."""
    trials = purse.phase(mutants, "structure", watch)
    trials.budget -= round(EXAMINING * trials.budget)
    signs = NO_SIGNS
    if found.early is not None:
        trials.know(found.early.trials)
        signs = NO_SIGNS if purse.late else found.early.signs(trials)
    structures = Structures(mutants.order, _chief(searched), trials, found.effects or {}, signs)
    examiner.turns += 1
    changes = structures.candidates()
    if found.constants is not None:
        analysis, goal = mutants.order.analysis, mutants.order.goal
        changes = constants_first(
            changes, found.constants, trials, goal, lambda one: scaled_command(analysis, one)
        )
    try:
        found.accepted = examiner.first(changes, trials)
    except KeyboardInterrupt:
        found.interrupted = True
    if found.accepted is not None and _structural(found.accepted):
        found.effects, found.method = structures.effects(), "structure"
    found.structural = gaining(found.structural or {}, structures.effects())
    found.curves += (SearchTrace("structure", tuple(trials.totals), tuple(trials.labels)),)
    purse.settle(trials)
    if found.accepted is None or _structural(found.accepted):
        found.structure = trials.spent


def _structural(accepted: Accepted) -> bool:
    return any(mutation.form is not None for mutation in accepted.candidate.mutations)


def _chief(searched: Sequence[Guard]) -> tuple[Guard, ...]:
    """Return the guards of structural changes."""
    return tuple(dict.fromkeys((candidates.ALWAYS, searched[0])))


def _rank(mutants: Mutants, found: _Findings, guard: Guard, watch: Watch) -> None:
    """Rank all sites under the guard of the repair, or else under the most promising guard."""
    if found.accepted is not None:
        guard = found.accepted.candidate.guard
    purse = Purse(mutants.order.options.budget, mutants.order.options.seconds)
    trials = purse.phase(mutants, "ranking", watch)
    ranking = strategies.ranking(mutants, guard, trials)
    try:
        ranking.run()
    except KeyboardInterrupt:
        found.interrupted = True
    found.effects, found.method, found.ranking = ranking.effects() or found.effects, "ranking", ranking
    found.curves += (SearchTrace("ranking", tuple(trials.totals), tuple(trials.labels)),)
    purse.settle(trials)
    found.take(purse)


def _exhibit(strategy: Strategy) -> None:
    """Run a search up to its first candidate, only for its curve in the report."""
    with suppress(BudgetSpentError):
        next(strategy.candidates(), None)


def _concluded(mutants: Mutants, examiner: Examiner, found: _Findings, watch: Watch) -> Repaired:
    order, accepted = mutants.order, found.accepted
    refused = watch.best_so_far(_ended(examiner, found))
    history = attempts(order, [*watch.unconfirmed(examiner.tried), *examiner.tried])
    chosen = accepted.candidate if accepted else examiner.refused.candidate
    totals, effects = dict(order.comparison.totals), gaining(found.effects or {}, found.structural or {})
    sizes = order.comparison.sizes
    bounds: Mapping[str, Guarantee] = {}
    spent = 0
    if accepted:
        sizes = repaired_sizes(order, examiner.ranged.get(accepted.candidate, Ranged()))
        totals["repaired"] = tuple(outcome.total for outcome in accepted.acceptance.drifted)
        nominal = tuple(outcome.total for outcome in accepted.acceptance.nominal)
        totals["nominal_repaired"] = nominal or totals["offline"]
        effects = with_confirmed(effects, accepted.candidate, totals["repaired"], totals["online"])
        with suppress(KeyboardInterrupt):  # Ctrl-C only skips the bounds; the repair stays accepted
            bounds, spent = guaranteed(mutants, accepted)
    part = None
    if accepted is None and not found.interrupted:
        with suppress(KeyboardInterrupt):
            helping, spent = best(mutants, examiner, watch)
            part = partial(mutants, helping) if helping is not None else None
    comparison = replace(
        order.comparison,
        formulas=_formulas(order, accepted),
        culprits=localize.culprits(
            _ranked(order, effects),
            effects,
            [str(mutation.operand.site) for mutation in chosen.mutations] if chosen else [],
            order.comparison.verdict.loss,
            found.method or "sweep",
        ),
        searches=found.curves,
        totals=totals,
        sizes=sizes,
        stated={**order.comparison.stated, **bounds},
        repair=delivered(mutants, accepted, found.episodes, examiner.spent, history, bounds)
        if accepted
        else replace(withheld(order, refused, history), partial=part),
        notes=(
            *order.comparison.notes,
            *(exceeding(order.comparison, totals) if accepted else ()),
            *_notes(mutants, examiner, found, watch),
        ),
        ranking=ranking_confidence(order, effects, accepted, found.ranking),
    )
    episodes = {"search": found.episodes, "acceptance": examiner.spent + spent}
    return Repaired(comparison, accepted, episodes, found.interrupted)


def _formulas(order: Order, accepted: Accepted | None) -> tuple[FormulaRow, ...]:
    """Return the verdicts on formulas, including the episodes in which an accepted repair was tested."""
    if accepted is None:
        return order.comparison.formulas
    worlds = {"repaired": accepted.acceptance.drifted, "nominal_repaired": accepted.acceptance.nominal}
    judged = {name: [one.judged for one in outcomes] for name, outcomes in worlds.items()}
    return with_worlds(order.comparison.formulas, judged)


def _ended(examiner: Examiner, found: _Findings) -> Refused:
    """Return the best refused candidate. If nothing was tested, its `reason` says what ended the search."""
    if found.interrupted:
        return replace(examiner.refused, reason="interrupted")
    if found.late and examiner.refused.reason == "budget":
        return replace(examiner.refused, reason="time")
    return examiner.refused


def _notes(mutants: Mutants, examiner: Examiner, found: _Findings, watch: Watch) -> Iterator[str]:
    """Yield notes that say what was not searched, which candidates were dropped, and what ended the search early."""
    order, accepted = mutants.order, found.accepted is not None
    told = found.accepted.candidate if found.accepted else examiner.refused.candidate
    if told is not None:
        yield from dict.fromkeys(examiner.placing.notes(told))
    yield from unnamed_modules(order)
    if found.accepted is not None:
        yield from remarks(mutants, found.accepted.candidate)
    yield from _of_the_range(order, examiner, watch)
    yield from (
        f"a candidate was dropped because it lowers the reward of another test: {told}"
        for told in dict.fromkeys(examiner.lost)
    )
    if found.structure:
        yield (
            f"no constant that was tried in {found.episodes - found.structure} episodes sufficed, so "
            f"{found.structure} further episodes tried structural changes"
        )
    if found.late:
        yield (
            f"the search ended after {order.options.seconds:g} s and {found.episodes} episodes; a time limit is not "
            f"reproducible: to repeat this search, use --tarl-budget {found.episodes}"
        )
    elif examiner.cut and not accepted and examiner.tested:
        yield (
            f"the search ended because its {order.options.budget} episodes were spent: "
            f"--tarl-budget {2 * order.options.budget} doubles them"
        )


def _of_the_range(order: Order, examiner: Examiner, watch: Watch) -> Iterator[str]:
    """Yield notes on candidates that work only in a part of the range."""
    for one in examiner.tried:
        ranged = examiner.ranged.get(one.candidate)
        if one.reason == "not over the whole range" and ranged is not None:
            yield f"{label(one.candidate)}: {bands_in_words(ranged)}"
    for candidate, runs in watch.seen.items():
        told = fits_a_part(order, runs) if len(runs) > NAMED_FROM else ""
        if told and candidate.changes not in [one.candidate.changes for one in examiner.tried]:
            yield f"{label(candidate)}: {told}"


def _ranked(order: Order, effects: Mapping[str, Sequence[OperandEffect]]) -> list[tuple[SitePlace, float]]:
    """Return the sites in the order of the slices, then the sites that the slices do not rank."""
    ranked = [(culprit.site, culprit.score) for culprit in order.comparison.culprits]
    known = {site.id for site, _ in ranked}
    analysis = order.analysis
    configuring = [step for step, _ in (*analysis.configuring.values(), *analysis.making.values())]
    aside = (*order.analysis.deciding, *order.analysis.timing, *configuring)
    late = [step for step in aside if str(step.site) in effects]
    for step in (*order.analysis.sites, *late):
        if str(step.site) not in known:
            span = step.span
            place = SitePlace(str(step.site), span.path, span.line, step.code, step.dependence, step.role)
            ranked.append((place, 0.0))
    return ranked
