"""Deliver the result: an accepted repair's patch, or the best refused candidate and why."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from math import nan
from pathlib import Path
from statistics import fmean

from pytest_tarl.errors import RepairError
from pytest_tarl.model import Attempt, Comparison, Edit, Guarantee, Partial, Repair
from pytest_tarl.patching import patch
from pytest_tarl.patching.merge import CONSTANT
from pytest_tarl.patching.mutate import Mutation
from pytest_tarl.patching.patch_reader import read
from pytest_tarl.patching.rewriting import guard_text
from pytest_tarl.patching.suggesting import sarif
from pytest_tarl.patching.verify import nothing_lost
from pytest_tarl.repairing.accepting import Accepted
from pytest_tarl.repairing.ledger import Refused, Tried
from pytest_tarl.repairing.mutants import Mutants
from pytest_tarl.repairing.partial import Best
from pytest_tarl.repairing.request import Order
from pytest_tarl.repairing.reviewing import remarks
from pytest_tarl.repairing.template_forms import form_words
from pytest_tarl.report import amounts, guarantee_words, next_commands, repair_words, words
from pytest_tarl.searching.search import Candidate, effective_value
from tarl_lint import __version__
from tarl_lint.files import write_atomically


def delivered(
    mutants: Mutants,
    accepted: Accepted,
    search: int,
    acceptance: int,
    history: tuple[Attempt, ...],
    bounds: Mapping[str, Guarantee],
) -> Repair:
    """Write the patch of an accepted repair. Raise RepairError.

    `search` and `acceptance` are numbers of episodes; `bounds` maps worlds to guarantees for the repaired program.
    """
    order, candidate = mutants.order, accepted.candidate
    guard = _guard(order, candidate)
    changed = mutants.source(candidate)
    _verify(order, candidate, changed)
    originals = {path: path.read_bytes() for path in changed}
    header = _evidence(mutants, accepted, guard, search, acceptance, bounds)
    diff = patch.unified_diff(originals, changed, order.root, header)
    place = _written(order, diff)
    return Repair(True, guard, _edits(order, candidate), patch.readable(diff), place, history=history)


def _written(order: Order, diff: str) -> str:
    """Write the patch and a SARIF file. Return the patch's path relative to the root, or "" on failure.

    If the patch cannot be written, the report shows the whole patch, so that the repair is not lost.
    """
    try:
        written = patch.write(diff, order.patches, order.fixture.test, order.drift)
    except RepairError:
        return ""
    with suppress(OSError):
        write_atomically(written.with_suffix(".sarif"), sarif(read(written)).encode(), parents=True)
    return written.relative_to(order.root).as_posix()


def _verify(order: Order, candidate: Candidate, changed: Mapping[Path, str]) -> None:
    """Check that the new files differ from the old ones only in the lines to change. Raise RepairError."""
    for shown, original in order.analysis.sources.items():
        text = changed.get(order.root / shown)
        if text is not None:
            here = [m.operand.span for m in candidate.mutations if m.place is None]
            spans = [span for span in here if span.path == shown]
            spans += [m.form.partner for m in candidate.mutations if m.form and m.form.partner]
            lines = {line for span in spans for line in range(span.line, span.end_line + 1)}
            lines |= {m.place.line for m in candidate.mutations if m.place and m.place.path == shown}
            nothing_lost(shown, original, text, lines)


def withheld(order: Order, refused: Refused, history: tuple[Attempt, ...]) -> Repair:
    """Return the best refused candidate and the reason for its refusal."""
    candidate = refused.candidate
    if candidate is None:
        return Repair(False, "", (), reason=refused.reason, history=history)
    return Repair(
        False,
        _guard(order, candidate),
        _edits(order, candidate),
        reason=refused.reason,
        mean=refused.mean if refused.episodes else None,
        episodes=refused.episodes,
        history=history,
    )


def partial(mutants: Mutants, found: Best) -> Partial | None:
    """Write a change that helps, but is not a repair, as quoted lines. Return None if writing fails."""
    order, candidate = mutants.order, found.candidate
    what = repair_words.repair_words(Repair(False, _guard(order, candidate), _edits(order, candidate)))
    made = Partial(
        what,
        found.drifted.mean,
        found.drifted.low,
        order.comparison.verdict.loss,
        found.designed.mean,
        found.designed.low,
        1.0 - order.options.alpha,
        "",
        "",
    )
    totals = order.comparison.totals
    header = [
        f"{patch.TITLE}{__version__}: partial, {words.one_line(what)}",
        f"partial: {repair_words.partial_words(made, order.comparison)}",
        f"test: {order.fixture.test}",
        f"drift: {words.one_line(order.drift or 'no drift is named; the test itself runs in the changed world')}",
        f"seed: {order.options.seed}",
        f"designed: {amounts.average(totals['offline'])}",
        f"drifted: {amounts.average(totals['online'])}",
        *_recorded(order),
        f"again: {_again(order)}",
    ]
    try:
        changed = mutants.source(candidate)
        _verify(order, candidate, changed)
        originals = {path: path.read_bytes() for path in changed}
        diff = patch.unified_diff(originals, changed, order.root, header)
        path = patch.write_partial(diff, order.patches, order.fixture.test, order.drift)
    except RepairError:
        return None
    return replace(made, diff=patch.readable(diff), patch=path.relative_to(order.root).as_posix())


def attempts(order: Order, tried: Iterable[Tried]) -> tuple[Attempt, ...]:
    """Describe the examined candidates and their results."""
    return tuple(
        Attempt(
            repair_words.repair_words(
                Repair(False, _guard(order, one.candidate), _edits(order, one.candidate))
            ),
            one.reason,
            fmean(one.totals) if one.totals else nan,
            len(one.totals),
            one.fresh,
        )
        for one in tried
    )


def _guard(order: Order, candidate: Candidate) -> str:
    try:
        return guard_text(candidate.guard, order.analysis, candidate.mutations, order.fixture.topics)
    except RepairError:  # the candidate was dropped because the node cannot evaluate its guard
        return " and ".join(
            f"{one.low:g} <= {one.sensor.name} <= {one.high:g}" for one in candidate.guard.conjuncts
        )


def _edits(order: Order, candidate: Candidate) -> tuple[Edit, ...]:
    """Return the edits in order. Uses that share a definition have only one edit."""
    placed = {one.place or one: one for one in reversed(candidate.mutations)}
    return tuple(_edit(order, one) for one in candidate.mutations if placed[one.place or one] is one)


def _edit(order: Order, mutation: Mutation) -> Edit:
    operand = mutation.operand
    if mutation.form is not None:
        value = amounts.expected(effective_value(mutation))
        return Edit(
            operand.span.path, operand.span.line, operand.code, value, what=form_words(order, mutation)
        )
    value = amounts.expected(effective_value(mutation))
    if mutation.place is not None:
        return Edit(mutation.place.path, mutation.place.line, mutation.place.name, value)
    return Edit(operand.span.path, operand.span.line, operand.code, value, operand.value is None)


def _evidence(
    mutants: Mutants,
    accepted: Accepted,
    guard: str,
    search: int,
    acceptance: int,
    bounds: Mapping[str, Guarantee],
) -> list[str]:
    """Return the header of the patch: the change and the evidence for it."""
    order = mutants.order
    totals = order.comparison.totals
    repaired = [outcome.total for outcome in accepted.acceptance.drifted]
    nominal = [outcome.total for outcome in accepted.acceptance.nominal]
    change = repair_words.repair_words(Repair(True, guard, _edits(order, accepted.candidate)))
    return [
        f"{patch.TITLE}{__version__}: {words.one_line(change)}",
        f"test: {order.fixture.test}",
        f"drift: {words.one_line(order.drift or 'no drift is named; the test itself runs in the changed world')}",
        f"seed: {order.options.seed}",
        f"designed: {amounts.average(totals['offline'])}",
        f"drifted: {amounts.average(totals['online'])}",
        f"drifted and repaired: {amounts.average(repaired)}, on held-out seeds",
        _designed_and_repaired(order, nominal),
        *dict.fromkeys(f"{CONSTANT}: {told}" for told in _constants(accepted.candidate)),
        *remarks(mutants, accepted.candidate),
        *(f"other test: {words.one_line(told)}" for told in accepted.beside.held),
        *_stated(bounds),
        f"episodes spent: search {search}, acceptance {acceptance}",
        *_recorded(order),
        *([f"record: {next_commands.recording(_in_root(order))}"] if order.permanent else []),
        f"again: {_again(order)}",
    ]


def _constants(candidate: Candidate) -> Iterator[str]:
    """Yield where the changed constants are defined. Two patches conflict if they change the same definition."""
    for mutation in candidate.mutations:
        operand = mutation.operand
        span = operand.definition or operand.span
        if mutation.form is None:
            yield words.one_line(f"{span.path}:{span.line} column {span.column}")


def _designed_and_repaired(order: Order, nominal: Sequence[float]) -> str:
    """Describe the reward of the repair in the designed world."""
    if order.permanent:
        return f"old world and repaired: {amounts.average(nominal)}; not required, because the drift is permanent"
    if nominal:
        return f"designed and repaired: {amounts.average(nominal)}, on held-out seeds"
    return "designed and repaired: as designed, because the condition never holds there"


def _stated(bounds: Mapping[str, Guarantee]) -> list[str]:
    """Return the guarantees for the repaired program in both worlds, as header lines."""
    names = {"repaired": "drifted and repaired", "nominal_repaired": "designed and repaired"}
    return [
        f"bounds, {names[world]}: {told}"
        for world, one in bounds.items()
        for told in guarantee_words.brief(one)
    ]


def _recorded(order: Order) -> list[str]:
    """Return the header line that gives the hash and the path of the recording used for the comparison."""
    path = order.recorded
    if path is None:
        return []
    return [
        f"fixture: {hashlib.sha256(path.read_bytes()).hexdigest()} {path.relative_to(order.root).as_posix()}"
    ]


def _again(order: Order) -> str:
    """Return the shell command that repeats the comparison if it is run in the root folder."""
    return next_commands.command(replace(_in_root(order), flags=order.options.flags))


def _in_root(order: Order) -> Comparison:
    """Return the comparison with its test named relative to the root."""
    return replace(order.comparison, target=order.fixture.test.partition("[")[0])
