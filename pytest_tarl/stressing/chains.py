"""Choose drifts to test on fresh seeds: chains that start far beyond the boundary and approach it.

The tests of a chain stop at the first drift that is not confirmed, which leaves the earlier ones confirmed. Each test
therefore uses the chain's full risk, not a share of it (fixed-sequence procedure; Maurer, Hothorn & Lehmacher 1995).
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

# the next drift counts as nearer if its distance is at most this share of the last confirmed drift's distance
NEARER = 0.98
# Limits for the probability that the tests at the farther drifts of a chain show too many failures. If the probability
# is at least LIKELY, the chain tests only the failure rate; if it is below UNLIKELY, only the loss.
LIKELY, UNLIKELY = 0.5, 0.05
ALIKE = 0.02  # two probabilities that differ by at most this count as equal
VETTED = 4  # maximum number of drifts that get SIZES[2] episodes before a chain is chosen
# drifts beyond the near end are chosen only if fresh episodes show their failure with at least this probability
POSSIBLE = 0.5
# A chain tests these multiples of its near end before the near end itself, if it tests only the failure rate and the
# same seeds fail under all its drifts.
OUTWARD = (1.12, 1.08, 1.04)
# all other chains test this multiple of their near end before the near end itself
BEFORE = (1.03,)
# A chain tests these multiples of its near end after the near end itself. The steps grow: several confirmations in a
# row mean that the model placed the boundary too far from nominal.
INWARD = (0.96, 0.92, 0.86, 0.79, 0.72, 0.65, 0.58, 0.5)
# a chain of small steps tests these multiples of its first drift
FINE = tuple(0.985**step for step in range(16))
# the farther drifts of a chain are chosen among these multiples of its near end
STRETCHES = (1.035, 1.065, 1.1, 1.15, 1.2, 1.3, 1.4, 1.5, 1.7)


@dataclass(frozen=True)
class Plan:
    """How to choose the drifts of a chain.

    The near end of a chain is the nearest drift that fails according to the model.

    - `errors`: assumed error of the model, in standard deviations
    - `depth`: required excess over the guarantee, in units of what fresh episodes can show
    - `steps`: one farther drift per step, described by two numbers: the minimum probability that fresh episodes show
      its failure, and its minimum distance as a multiple of the previous drift's distance
    """

    errors: float
    depth: float
    steps: tuple[tuple[float, float], ...]


# the plan until the first drift in several directions is confirmed, and the plan afterwards
FIRST = Plan(0.5, 1.2, ((0.9, 1.06), (0.95, 1.06), (0.98, 1.2)))
NEXT = Plan(0.35, 1.05, ((0.9, 1.03),))


def chain(nearest: Nearest, plan: Plan, limit: float) -> list[Point]:
    """Return the drifts of a chain, farthest first, all nearer than `limit`.

    If the options of the nearest failing drift are outside the model, the chain has only this drift. The chain is empty
    if no drift has failed. Raise BudgetSpentError.
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
    """Return the part of the guarantee that a chain should test, according to the model.

    The model's prediction for the last (nearest) drift decides. If the prediction is not clear, the chain tests both
    parts.
    """
    coordinates = nearest.coordinates
    if not chain or not all(map(coordinates.covers, chain)):
        return "both"
    by_loss, by_rate = nearest.model().shown_by(np.array([coordinates.vector(point) for point in chain]))
    if by_rate[-1] >= by_loss[-1] and (by_rate[:-1] >= LIKELY).all():
        return "rate"
    return "loss" if by_rate.max() < UNLIKELY else "both"


def likely(nearest: Nearest, point: Point) -> bool:
    """Return whether the model covers a drift and expects fresh episodes to show its failure."""
    coordinates = nearest.coordinates
    if not coordinates.covers(point):
        return False
    return float(nearest.model().failing(coordinates.vector(point)[None, :])[0]) >= POSSIBLE


def finer(nearest: Nearest, chain: Sequence[Point], part: Part) -> list[Point]:
    """Add drifts on the ray through a chain's near end, if the model covers the near end.

    One more drift needs fewer episodes in this chain than in a new one: the nominal episodes have already run, and a
    test of the failure rate starts with the seeds that failed before.
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
    """Return a chain of drifts in small steps that starts slightly nearer than a confirmed drift.

    The drifts lie on the ray through one of three drifts: the confirmed one, the nearest predicted one, or the nearest
    one that failed in the search. The one most likely to be confirmed is chosen. The chain is empty if the model does
    not cover the confirmed drift, or if no drift has failed.
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
    """Return up to three drifts in several directions that failed in the search, farthest first.

    They are tested if none of the predicted drifts is confirmed, because the model may be wrong. The failed drifts are
    sorted from farthest to nearest; the three are those at one half, at three quarters and at the end of this list. The
    search runs no further episodes at them.
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
    """Run more episodes at the nearest predicted drifts; return the first that the model still expects to fail.

    The model often errs at the nearest of many predicted drifts, so these need more episodes. Return None if no drift
    fails. Raise BudgetSpentError.
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
    """Return one drift for each step of the plan, farthest first, all nearer than `limit`.

    Candidates are multiples of `near` and drifts tried before. Each step takes the nearest candidate that is likely
    enough to be confirmed. If there is none, it takes the nearest of those whose probability is about the largest. The
    plan ends early if every candidate's probability is below `POSSIBLE`.
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

    If fresh episodes are likely to show too many failures at the near end, only the failure rate counts, because then
    the whole chain tests only the failure rate.
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
    """Return vectors sorted by length, shortest first; shape (drifts, ranges)."""
    found = np.array(vectors)
    ordered: Vector = found[np.argsort(np.linalg.norm(found, axis=1), kind="stable")]
    return ordered
