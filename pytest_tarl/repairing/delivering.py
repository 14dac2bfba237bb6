"""What is handed over in the end: the patch of a repair that held, or the best one and why it was refused."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from statistics import fmean

from pytest_tarl.model import Edit, Repair
from pytest_tarl.patching import patch
from pytest_tarl.patching.mutate import Mutation, guard_text
from pytest_tarl.patching.verify import nothing_lost
from pytest_tarl.repairing.accepting import Accepted, Refused
from pytest_tarl.repairing.mutants import Mutants
from pytest_tarl.repairing.order import Order
from pytest_tarl.searching.search import Candidate, effective_value


def delivered(mutants: Mutants, accepted: Accepted, search: int, acceptance: int) -> Repair:
    """Write the patch of an accepted repair; the counts are the episodes that it took to find it."""
    order, candidate = mutants.order, accepted.candidate
    guard = _guard(order, candidate)
    changed = mutants.source(candidate)
    _verify(order, candidate, changed)
    originals = {path: path.read_bytes() for path in changed}
    header = [
        *_evidence(order, accepted, guard),
        f"episodes spent: search {search}, acceptance {acceptance}",
    ]
    diff = patch.unified_diff(originals, changed, order.root, header)
    written = patch.write(diff, order.patches, order.fixture.test, order.drift)
    place = written.relative_to(order.root).as_posix()
    return Repair(True, guard, _edits(candidate), patch.readable(diff), place)


def _verify(order: Order, candidate: Candidate, changed: Mapping[Path, str]) -> None:
    """Look at the files once more before they become a patch. Raises RepairError when one would lose something."""
    for shown, original in order.analysis.sources.items():
        text = changed.get(order.root / shown)
        if text is not None:
            spans = [m.operand.span for m in candidate.mutations if m.operand.span.path == shown]
            lines = {line for span in spans for line in range(span.line, span.end_line + 1)}
            nothing_lost(shown, original, text, lines)


def withheld(order: Order, refused: Refused) -> Repair:
    """Tell the best candidate that was refused, and why."""
    candidate = refused.candidate
    if candidate is None:
        return Repair(False, "", (), reason=refused.reason)
    return Repair(False, _guard(order, candidate), _edits(candidate), reason=refused.reason)


def _guard(order: Order, candidate: Candidate) -> str:
    return guard_text(candidate.guard, order.analysis, candidate.mutations, order.fixture.topics)


def _edits(candidate: Candidate) -> tuple[Edit, ...]:
    return tuple(_edit(mutation) for mutation in candidate.mutations)


def _edit(mutation: Mutation) -> Edit:
    operand = mutation.operand
    value = effective_value(mutation)
    return Edit(operand.span.path, operand.span.line, operand.code, value, operand.value is None)


def _evidence(order: Order, accepted: Accepted, guard: str) -> list[str]:
    """Return what the patch's header tells: test, drift, seed, rewards before and after."""
    totals = order.comparison.totals
    repaired = [outcome.total for outcome in accepted.acceptance.drifted]
    nominal = [outcome.total for outcome in accepted.acceptance.nominal]
    return [
        f"Repair of {order.fixture.test} under the drift {order.drift or 'on-line'}, seed {order.options.seed}",
        f"when: {guard or 'always'}",
        (
            f"reward per episode: off-line {fmean(totals['offline']):.4g}, on-line {fmean(totals['online']):.4g}, "
            f"repaired {fmean(repaired):.4g} ({len(repaired)} fresh episodes)"
        ),
        f"designed world: {fmean(nominal):.4g} ({len(nominal)} fresh episodes)"
        if nominal
        else "designed world: the guard never holds there",
    ]
