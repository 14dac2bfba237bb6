"""Move single directions of a drift towards nominal, where the margin jumps.

At a jump, the guarantee clearly fails at a drift and holds slightly nearer to nominal on the same ray. A smooth model
is wrong on both sides of the jump. Only some of the drift's directions cause the jump; the others can move nearer to
nominal, and the guarantee still fails.
"""

from __future__ import annotations

from collections.abc import Iterator

from pytest_tarl.spaces import Choice, Point
from pytest_tarl.stressing.evaluating import SIZES, Evaluator
from pytest_tarl.stressing.guarantee import Part
from pytest_tarl.stressing.prediction import Shown
from pytest_tarl.stressing.rays import distance
from pytest_tarl.stressing.shrinking import weighted

# a drift is at a jump if its failure rate or excess loss is at least this many times what fresh episodes can detect
STEEP = 2.0
LOST = 0.25  # minimum excess loss at a jump, in units of the tolerated loss
SMALL = 0.9  # weight of the first step; if the guarantee then holds, the direction causes the jump
HALVINGS = 2  # number of bisections between a weight that fails and one that holds


def broken(point: Point, evaluator: Evaluator, shown: Shown) -> Part | None:
    """Return the part of the guarantee that a drift breaks by so much that it may be at a jump, or None.

    `shown` is what fresh episodes can detect.
    """
    counts = [one for one in evaluator.counts if one.point == point]
    failed, episodes = sum(one.failed for one in counts), sum(one.episodes for one in counts)
    lost = 0.0
    if evaluator.knows(point):
        losses, among = evaluator.losses(point)
        failed, episodes = failed + among, episodes + len(losses)
        lost = sum(losses) / len(losses) - 1.0
    if episodes and failed >= STEEP * shown.share * episodes:
        return "rate"
    return "loss" if lost >= max(STEEP * shown.depth, LOST) else None


def trimmed(point: Point, evaluator: Evaluator, tried: list[Point]) -> Iterator[Point]:
    """Yield failing drifts, each nearer to nominal in one direction than the previous one; options do not change.

    Append every drift that gets episodes to `tried`. Raise BudgetSpentError.
    """
    space, now = evaluator.space, dict(point)
    ranges = [
        name
        for name, extent in space.extents.items()
        if not isinstance(extent, Choice) and point[name] != space.nominal[name]
    ]
    for name in sorted(ranges, key=lambda one: -distance(space, {**space.nominal, one: point[one]})):
        low, high = 0.0, 1.0
        weights = [SMALL, 0.0]
        for step in range(len(weights) + HALVINGS):
            weight = weights[step] if step < len(weights) else (low + high) / 2
            moved = {**now, name: weighted(space, name, point[name], weight)}
            if _fails(moved, evaluator, tried):
                now, high = moved, weight
                yield now
            else:
                low = max(low, weight)
            if high == 0.0 or low >= SMALL:
                break


def _fails(point: Point, evaluator: Evaluator, tried: list[Point]) -> bool:
    """Return whether a few episodes show a failure; run more only if the first ones suggest it."""
    found = evaluator.examine(point, SIZES[0])
    tried.append(point)
    return found.failing and evaluator.examine(point, SIZES[1]).result == "fails"
