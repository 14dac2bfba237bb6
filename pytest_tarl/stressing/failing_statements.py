"""Find the statements that run only in failing episodes.

Episodes of the search are repeated with the same drifts and seeds, this time with their statements recorded. The
repetitions do not count towards the budget.
"""

from __future__ import annotations

import ast
from collections import Counter
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import islice, zip_longest
from pathlib import Path

from pytest_tarl.instrumentation.sites import Position, Positions
from pytest_tarl.rollout import EpisodePlan, Rollout, in_order
from pytest_tarl.spaces import Point
from pytest_tarl.stressing.evaluating import RAYS, Evaluator
from pytest_tarl.stressing.findings import Curve, Executed, Failure, Statements

FAILING, OTHERS = 16, 32  # maximum numbers of failing and other episodes to repeat
_DECLARING = (  # statements that only declare something, or do nothing
    ast.FunctionDef,
    ast.AsyncFunctionDef,
    ast.ClassDef,
    ast.Import,
    ast.ImportFrom,
    ast.Global,
    ast.Nonlocal,
    ast.Pass,
)


@dataclass(frozen=True)
class Source:
    """The statements of the nodes' files, numbered across files.

    `rollout` returns a rollout that records which of the statements at the given positions run.
    """

    places: tuple[tuple[str, int, str], ...]  # (file as shown to users, line, text) of each statement
    positions: Mapping[Path, Positions]
    rollout: Callable[[Mapping[Path, Positions]], Rollout]


def source(
    files: Sequence[Path], root: Path, rollout: Callable[[Mapping[Path, Positions]], Rollout]
) -> Source:
    """Return the statements of files; skip files that cannot be read or parsed."""
    places: list[tuple[str, int, str]] = []
    positions: dict[Path, Positions] = {}
    for path in files:
        name = path.relative_to(root).as_posix() if path.is_relative_to(root) else path.name
        try:
            text = path.read_text("utf-8")
            found = [*places_in(text)]
        except (OSError, ValueError, SyntaxError, RecursionError):
            continue
        positions[path] = {place: len(places) + number for number, place in enumerate(found)}
        lines = text.split("\n")
        places += [(name, line, lines[line - 1].strip()) for line, _ in found]
    return Source(tuple(places), positions, rollout)


def places_in(text: str) -> Iterator[Position]:
    """Yield the position of each statement that does something, in source order. Raise SyntaxError."""
    lines = text.split("\n")
    nodes = (one for one in ast.walk(ast.parse(text)) if isinstance(one, ast.stmt) and _does_something(one))
    found = {(one.lineno, one.col_offset) for one in nodes}
    for line, offset in sorted(found):
        yield line, len(lines[line - 1].encode()[:offset].decode()) + 1


def _does_something(node: ast.stmt) -> bool:
    quiet = isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant)
    return not (quiet or isinstance(node, _DECLARING))


def statements(
    given: Source, evaluator: Evaluator, curves: Sequence[Curve], failures: Sequence[Failure]
) -> Statements | None:
    """Return the statements that run only in failures, or None if there is nothing to compare."""
    failing, others = chosen(evaluator, curves, failures)
    if not failing or not others or not given.places:
        return None
    rollout = given.rollout(given.positions)
    ran = [_run(rollout, plans) for plans in (failing, others)]
    return Statements(len(failing), len(others), only_in_failures(given.places, *ran))


def only_in_failures(
    places: Sequence[tuple[str, int, str]],
    failing: Sequence[Collection[int]],
    others: Iterable[Collection[int]],
) -> tuple[Executed, ...]:
    """Return the statements that ran only in failing episodes, most frequent first."""
    elsewhere = {number for one in others for number in one}
    counts = Counter(number for one in failing for number in one if number not in elsewhere)
    order = sorted(counts, key=lambda number: (-counts[number], number))
    return tuple(Executed(*places[number], counts[number]) for number in order)


def chosen(
    evaluator: Evaluator, curves: Sequence[Curve], failures: Sequence[Failure]
) -> tuple[list[EpisodePlan], list[EpisodePlan]]:
    """Return episodes of confirmed failures, and similar episodes that do not fail.

    Both lists alternate between drifts. The episodes that do not fail come from failing drifts first, then from the
    nominal drift, then from drifts at which the guarantee holds.
    """
    fails: list[list[EpisodePlan]] = []
    passes: list[list[EpisodePlan]] = []
    for one in failures:
        known = [episode for pool in evaluator.fresh_pools for episode in evaluator.recalled(pool, one.point)]
        fails.append([plan for plan, failed in known if failed])
        passes.append([plan for plan, failed in known if not failed])
    usual = evaluator.space.nominal
    points: list[tuple[str, Point]] = [(pool, usual) for pool in evaluator.fresh_pools]
    points += [(RAYS, curve.ray.point(curve.held)) for curve in curves if curve.held]
    points += [
        ("search", curve.ray.point(t))
        for curve in curves
        for t, one in sorted(curve.evidence.items(), reverse=True)
        if one.result == "holds"
    ]
    passes += [
        [plan for plan, failed in evaluator.recalled(pool, point) if not failed] for pool, point in points
    ]
    return [*islice(_in_turn(fails), FAILING)], [*islice(_in_turn(passes), OTHERS)]


def _in_turn(lists: Sequence[Sequence[EpisodePlan]]) -> Iterator[EpisodePlan]:
    for row in zip_longest(*lists):
        yield from (one for one in row if one is not None)


def _run(rollout: Rollout, plans: Sequence[EpisodePlan]) -> list[set[int]]:
    """Return, for each episode, the numbers of the statements that it runs."""
    recording = (replace(plan, record=True) for plan in plans)
    return [set(pending.result().trace.site.tolist()) for pending in in_order(rollout, recording)]
