"""Create the searches by name, each with its operands in order, its guards and its random generator."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

from pytest_tarl import seeds
from pytest_tarl.model import Guard
from pytest_tarl.repairing.file_parameters import file_parameters, is_table, reads_one, uses_of
from pytest_tarl.repairing.labels import quantities
from pytest_tarl.repairing.mutants import Mutants
from pytest_tarl.repairing.name_scopes import name_scope
from pytest_tarl.repairing.products import one_of_each
from pytest_tarl.repairing.request import Order
from pytest_tarl.repairing.scales import charts
from pytest_tarl.repairing.table_entries import entry_uses
from pytest_tarl.searching import candidates
from pytest_tarl.searching.ask_tell import Asking, factory
from pytest_tarl.searching.epsilon_greedy import EpsilonGreedy
from pytest_tarl.searching.halving import Halving
from pytest_tarl.searching.plainness import writing
from pytest_tarl.searching.ranking import Ranking
from pytest_tarl.searching.search import Trials
from pytest_tarl.searching.strategy import Strategy
from pytest_tarl.searching.suggestions import NO_SUGGESTIONS, Suggestions
from pytest_tarl.searching.sweep import Sweep
from pytest_tarl.searching.units import sets_up
from tarl_lint.api import Analysis
from tarl_lint.model import Operand, SiteId

MOST_GUARDS = 3  # maximum number of guards per search


def strategy(
    mutants: Mutants,
    method: str,
    guards: Sequence[Guard],
    trials: Trials,
    suggestions: Suggestions = NO_SUGGESTIONS,
) -> Strategy:
    """Return the search with this name. Raise SearchError or SettingsError for unsuitable plug-ins.

    Only the sweep asks for `suggestions`.
    """
    order = mutants.order
    generator = seeds.generator(order.options.seed, method)
    if method == "sweep":
        every = operands(order)
        moved, same = one_of_each(order.analysis, every)
        return Sweep(
            moved,
            mutants.mutate,
            guards,
            trials,
            order.goal,
            generator,
            late=same,
            aside=aside_operands(order, every),
            structure_follows=order.options.structure,
            charts=charts(order, moved),
            scope=name_scope(order.analysis),
            suggestions=suggestions,
        )
    if method == "halving":
        return Halving(operands(order), mutants.mutate, guards, trials, order.goal)
    if method == "epsilon-greedy":
        return EpsilonGreedy(
            operands(order),
            mutants.mutate,
            tuple(dict.fromkeys((guards[0], candidates.ALWAYS))),
            trials,
            order.goal,
            seeds.episode_seeds(order.options.seed, "search", EpsilonGreedy.episodes(trials.budget)),
            generator,
        )
    chief = guards[: 2 if guards[0].conjuncts else 1]
    seed = int(generator.integers(1, 2**31))
    make = factory(method, (Path.cwd(), order.root))
    return Asking(method, make, operands(order), mutants.mutate, chief, trials, order.goal, seed)


def ranking(mutants: Mutants, guard: Guard, trials: Trials) -> Ranking:
    """Return the ranking of all sites."""
    return Ranking(operands(mutants.order), mutants.mutate, guard, trials, mutants.order.goal)


def operands(order: Order) -> tuple[Operand, ...]:
    """Return all operands of the flows, with the most readable changes first, then by slice.

    Among the operands are entries of tables of settings (see `table_entries`). There are also constants that start-up
    code passes to a library object or stores in a list; they rank like the statements that use the object.
    """
    analysis = order.analysis
    rank = {culprit.site.id: i for i, culprit in enumerate(order.comparison.culprits)}
    ranks = {step.site: rank.get(str(step.site), len(rank)) for step in analysis.sites}
    found = {o: ranks[site] for site in ranks for o in analysis.operands(site)}
    defined = {(o.definition.path, o.definition.line) for o in found if o.definition is not None}
    entries = entry_uses(analysis, [o for site in analysis.configuring for o in analysis.operands(site)])
    found |= {use: ranks[use.site] for uses in entries.values() for use in uses}
    for site, (_, users) in analysis.configuring.items():
        given = analysis.operands(site)
        given = tuple(o for o in given if o not in entries)
        best = min(ranks.get(user, len(rank)) for user in users)
        own = [o for o in given if o.definition is not None and o.definition.line == o.span.line]
        # operands of this statement were already found where other statements read them
        if any((o.span.path, o.span.line) in defined for o in own):
            given = tuple(o for o in given if o not in own)
        found |= dict.fromkeys(given, best)
    found |= _given_to_several(analysis, found, ranks)
    ordered = sorted(found, key=lambda o: found[o])
    kept = [one for one in quantities(analysis, dict.fromkeys(ordered)) if not is_table(order, one)]
    return tuple(sorted(_with_parameters(order, kept), key=writing))


def _with_parameters(order: Order, operands: Sequence[Operand]) -> list[Operand]:
    """Return the parameters in files that no operand represents, then the operands.

    If a call reads one of these parameters, the call is left out. It is kept if a repair may need a condition, because
    conditions are written at uses. If a statement that is in no data flow uses the parameter while the node runs, this
    use takes the place of the parameter: a condition can be written there, and the statement is a possible place for
    the repair.
    """
    inside = file_parameters(order, operands)
    calls = {one.span for one in inside} if inside and order.permanent else set()
    kept = [one for one in operands if one.span not in calls or not reads_one(order.analysis, one)]
    aside = quantities(order.analysis, _aside(order.analysis)) if inside else []
    aside = [one for one in aside if not sets_up(one)]
    used = [uses_of(order.analysis, one, aside) or (one,) for one in inside]
    return [*dict.fromkeys(use for uses in used for use in uses), *kept]


def _given_to_several(
    analysis: Analysis, found: Mapping[Operand, int], ranks: Mapping[SiteId, int]
) -> dict[Operand, int]:
    """Map constants that are passed to several objects of one class to the rank of their best user.

    If a class has only one object, the constant is found where the object uses it. If the class has several objects,
    such as two wheels, one use reads several constants. Then each constant is changed where its object is made.
    """
    known = {one.definition for one in found}
    last = len(ranks)
    return {
        one: min(ranks.get(user, last) for user in users)
        for site, (_, users) in analysis.making.items()
        for one in analysis.operands(site)
        if one.definition is not None and one.definition not in known
    }


def aside_operands(order: Order, ranked: Sequence[Operand]) -> tuple[Operand, ...]:
    """Return operands that decide when nodes publish but are in no data flow. The most readable come first.

    The operands in `ranked`, which the slices rank, are left out.
    """
    known = set(ranked)
    new = [one for one in _aside(order.analysis) if one not in known and not is_table(order, one)]
    return tuple(sorted(quantities(order.analysis, new), key=writing))


def _aside(analysis: Analysis) -> list[Operand]:
    """Return the operands of statements that decide when nodes publish but are in no data flow."""
    steps = (*analysis.timing, *analysis.deciding)
    return list(dict.fromkeys(o for step in steps for o in analysis.operands(step.site)))


def evidence(order: Order) -> candidates.Evidence:
    """Return the data from which guards are derived."""
    comparison = order.comparison
    return candidates.Evidence(
        comparison.sensors,
        order.fixture.sample,
        order.online.recorded.sample,
        comparison.region,
        comparison.changes,
    )
