"""Choose the drifts that are tested on fresh seeds: chains that lead from far beyond the boundary towards it.

The tests of a chain stop at the first drift that is not confirmed, so the drifts before it are confirmed in any case.
Each drift is tested at the whole risk of the chain (fixed-sequence procedure; Maurer, Hothorn & Lehmacher 1995).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import inf, sqrt

import numpy as np

from pytest_tarl import seeds
from pytest_tarl.spaces import Point
from pytest_tarl.stressing.coordinates import Vector
from pytest_tarl.stressing.evaluating import NEAREST, SIZES
from pytest_tarl.stressing.guarantee import Part
from pytest_tarl.stressing.nearest import Nearest

NEARER = 0.98  # maximum distance of the next confirmed drift, as a share of the distance of the last one
# Limits of the probability that a test at the farther drifts of a chain shows too many failures: from LIKELY on, the
# chain tests only the failure rate; below UNLIKELY, it tests only the loss.
LIKELY, UNLIKELY = 0.5, 0.05
ALIKE = 0.02  # probabilities whose difference is at most this count as the same
VETTED = 4  # maximum number of drifts that run SIZES[2] episodes before a confirmation
POSSIBLE = 0.5  # minimum probability that fresh episodes show the failure of a drift beyond the near end
# multiples of the near end of a chain that are tested before the near end, if the chain tests only the failure rate
# and the same seeds fail under all drifts
OUTWARD = (1.12, 1.08, 1.04)
# multiples of the near end that all other chains test before the near end
BEFORE = (1.03,)
# multiples of the near end that a chain tests after the near end; the steps grow, because several confirmations in a
# row show that the model expected the boundary too far out
INWARD = (0.96, 0.92, 0.86, 0.79, 0.72, 0.65, 0.58, 0.5)
FINE = tuple(0.985**step for step in range(16))  # in a chain of small steps, multiples of its first drift
# multiples of the drift at the near end of a chain that may become drifts of the chain
STRETCHES = (1.035, 1.065, 1.1, 1.15, 1.2, 1.3, 1.4, 1.5, 1.7)


@dataclass(frozen=True)
class Plan:
    """How to choose the drifts of a chain.

    The near end is the nearest drift that fails according to the model: `errors` are the errors of the model to allow
    for, in standard deviations, and `depth` is the excess over the guarantee, in units of what fresh episodes can show.
    Each of `steps` adds a farther drift. A step contains the minimum probability that fresh episodes show the failure
    of this drift, and its minimum distance as a multiple of the distance of the drift before it.
    """

    errors: float
    depth: float
    steps: tuple[tuple[float, float], ...]


# plan of chains until the first drift in several directions is confirmed, and plan of the chains afterwards
FIRST = Plan(0.5, 1.2, ((0.9, 1.06), (0.95, 1.06), (0.98, 1.2)))
NEXT = Plan(0.35, 1.05, ((0.9, 1.03),))


def chain(nearest: Nearest, plan: Plan, limit: float) -> list[Point]:
    """Return the drifts of a chain, nearer than `limit`, those farthest from nominal first.

    If the model does not cover the nearest failing drift because of its options, the chain has only this drift. The
    chain is empty if no tried drift fails. Raise BudgetSpentError.
    """
    best, limit = nearest.best, NEARER * limit
    if best is None:
        return []
    if not nearest.coordinates.covers(best):
        return [best] if nearest.distance(best) < limit else []
    near = _vetted(nearest, plan) or best
    if nearest.distance(near) >= limit:
        return []
    return [*_beyond(nearest, plan, near, limit), near]


def part_of(nearest: Nearest, chain: Sequence[Point]) -> Part:
    """Return the part of the guarantee that the tests of a chain are about, according to the model.

    The nearest drift of the chain decides, which is the last one. If the model is not clear, both parts are tested.
    """
    coordinates = nearest.coordinates
    if not chain or not all(map(coordinates.covers, chain)):
        return "both"
    by_loss, by_rate = nearest.model().shown_by(np.array([coordinates.vector(point) for point in chain]))
    if by_rate[-1] >= by_loss[-1] and (by_rate[:-1] >= LIKELY).all():
        return "rate"
    return "loss" if by_rate.max() < UNLIKELY else "both"


def likely(nearest: Nearest, point: Point) -> bool:
    """Return whether the model covers a drift and expects that fresh episodes show its failure."""
    coordinates = nearest.coordinates
    if not coordinates.covers(point):
        return False
    return float(nearest.model().failing(coordinates.vector(point)[None, :])[0]) >= POSSIBLE


def finer(nearest: Nearest, chain: Sequence[Point], part: Part) -> list[Point]:
    """Return a chain with further drifts on the ray through its near end, if the model covers this end.

    Each takes fewer episodes than a chain of its own: its nominal episodes have run already, and a test about the rate
    of failures first runs the seeds that failed before.
    """
    coordinates = nearest.coordinates
    if not chain or not coordinates.covers(chain[-1]):
        return [*chain]
    near, length = coordinates.vector(chain[-1]), nearest.distance(chain[-1])
    before = nearest.distance(chain[-2]) if len(chain) > 1 else inf
    outward: Sequence[float] = BEFORE if len(chain) > 1 else ()
    if part == "rate":
        outward = OUTWARD if nearest.model().luck > 0.0 else ()
    farther = [
        coordinates.point(np.clip(share * near, coordinates.low, coordinates.high)) for share in outward
    ]
    return [
        *chain[:-1],
        *(point for point in farther if length < nearest.distance(point) < before),
        chain[-1],
        *(coordinates.point(share * near) for share in INWARD),
    ]


def closer(nearest: Nearest, confirmed: Point) -> list[Point]:
    """Return a chain of drifts in small steps that begins a little nearer than a confirmed drift.

    The direction is that of the confirmed drift, of the nearest predicted one or of the nearest one that failed in the
    search, whichever is most likely to be confirmed. The chain is empty if the model does not cover the confirmed
    drift, or if no tried drift fails.
    """
    coordinates = nearest.coordinates
    if not coordinates.covers(confirmed) or nearest.best is None:
        return []
    evaluator = nearest.evaluator
    draws = seeds.generator(evaluator.seed, f"stress {evaluator.drift} closer {len(nearest.tested)}")
    towards = [confirmed, nearest.predicted(NEXT.errors, NEXT.depth, draws), nearest.best]
    covered = [
        coordinates.vector(point) for point in towards if point is not None and coordinates.covers(point)
    ]
    vectors = np.array([vector for vector in covered if vector.any()])
    if not len(vectors):
        return []
    room = sqrt(max((NEARER * nearest.distance(confirmed)) ** 2 - coordinates.options, 0.0))
    vectors *= room / np.linalg.norm(vectors, axis=1, keepdims=True)
    vectors = np.clip(vectors, coordinates.low, coordinates.high)
    vector = vectors[int(np.argmax(nearest.model().failing(vectors)))]
    return [coordinates.point(share * vector) for share in FINE]


def clear(nearest: Nearest) -> list[Point]:
    """Return up to three drifts in several directions that failed in the search, those farthest from nominal first.

    They are tested if none of the predicted drifts is confirmed, because the model may be wrong. If the drifts are
    sorted from the farthest to the nearest, the three are at half of the list, at three quarters and at the end. The
    search runs no further episodes there.
    """
    usual, evaluator = nearest.evaluator.space.nominal, nearest.evaluator
    found = [
        point
        for point in nearest.tried
        if nearest.coordinates.covers(point)
        and sum(point[name] != usual[name] for name in usual) > 1
        and evaluator.known(point).result == "fails"
    ]
    found.sort(key=lambda point: (-nearest.distance(point), *point.values()))
    places = dict.fromkeys((len(found) // 2, 3 * len(found) // 4, len(found) - 1))
    return [found[place] for place in places] if found else []


def _vetted(nearest: Nearest, plan: Plan) -> Point | None:
    """Return the nearest drift that fails according to the model, even after further episodes there.

    The nearest of many predicted drifts is often one at which the model errs. Return None if no drift fails. Raise
    BudgetSpentError.
    """
    evaluator = nearest.evaluator
    draws = seeds.generator(evaluator.seed, f"stress {evaluator.drift} vetting {len(nearest.tried)}")
    for _ in range(VETTED):
        point = nearest.predicted(plan.errors, plan.depth, draws)
        if point is None or evaluator.left < SIZES[2] + 2 * NEAREST[-1]:
            return point
        evaluator.common(point, SIZES[2])
        nearest.tried.append(point)
        vector = nearest.coordinates.vector(point)
        if nearest.model().deeper(plan.depth).excess(vector[None, :], plan.errors)[0] >= 0.0:
            return point
    return None


def _beyond(nearest: Nearest, plan: Plan, near: Point, limit: float) -> list[Point]:
    """Return a drift for each step of the plan, nearer than `limit`, those farthest from nominal first.

    The drifts are multiples of `near` or have been tried before. A step takes the nearest drift that is likely enough
    to be confirmed, or else the nearest one that is about as likely as the likeliest one. The plan ends early if no
    drift is at least `POSSIBLE`.
    """
    coordinates = nearest.coordinates
    vectors = _sorted([*_multiples(nearest, near), *nearest.vectors()])
    lengths = np.sqrt((vectors**2).sum(axis=1) + coordinates.options)
    chances = _chances(nearest, near, vectors)
    found: list[Point] = []
    last = nearest.distance(near)
    for least, apart in plan.steps:
        allowed = (lengths > apart * last) & (lengths < limit) & (chances >= POSSIBLE)
        if not allowed.any():
            break
        place = int(np.argmax(allowed & (chances >= min(least, chances[allowed].max() - ALIKE))))
        found.insert(0, coordinates.point(vectors[place]))
        last = float(lengths[place])
    return found


def _chances(nearest: Nearest, near: Point, vectors: Vector) -> Vector:
    """Return the probabilities that fresh episodes show a failure at vectors.

    If the near end fails too often, only such failures count, because the whole chain is then tested for them.
    """
    model = nearest.model()
    if part_of(nearest, [near]) == "rate":
        return model.shown_by(vectors)[1]
    return model.failing(vectors)


def _multiples(nearest: Nearest, near: Point) -> list[Vector]:
    coordinates = nearest.coordinates
    vector = coordinates.vector(near)
    return [np.clip(stretch * vector, coordinates.low, coordinates.high) for stretch in STRETCHES]


def _sorted(vectors: list[Vector]) -> Vector:
    """Return vectors by their lengths, ascending; shape (drifts, ranges)."""
    found = np.array(vectors)
    ordered: Vector = found[np.argsort(np.linalg.norm(found, axis=1), kind="stable")]
    return ordered
