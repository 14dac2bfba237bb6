"""The results of a stress run: margins along rays, boundaries, failing combinations."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from math import inf
from typing import Any

from pytest_tarl.spaces import Point, Space, Span
from pytest_tarl.stressing.guarantee import Evidence, Guarantee
from pytest_tarl.stressing.rays import Ray, distance

CONFIDENCE = 0.9  # confidence of the interval reported for a boundary
# maximum probability that the guarantee still holds at the interval's far end
FAR_RISK = (1.0 - CONFIDENCE) / 6
NEARER = 0.98  # one distance counts as nearer than another if it is at most this share of it
# a failure that contains a nearer one is reported only if it is at least this many times as far away
APART = 1.03
# maximum probability that the guarantee already fails at the interval's near end
NEAR_RISK = 1.0 - CONFIDENCE - FAR_RISK


@dataclass
class Curve:
    """The evidence along a ray, indexed by the position t; the search adds to it.

    Each of the following was decided on fresh seeds:

    - `confirmed`: the nearest t that failed
    - `farther`: every other t that failed
    - `rejected`: each t at which no failure was shown
    """

    ray: Ray
    evidence: dict[float, Evidence] = field(default_factory=dict)
    confirmed: float | None = None
    farther: tuple[float, ...] = ()
    rejected: tuple[float, ...] = ()
    held: float | None = None  # farthest t at which fresh seeds showed that the guarantee holds
    swept: bool = False  # whether the coarse sweep is complete

    def confirm(self, t: float) -> None:
        """Store t, at which fresh seeds showed a failure."""
        every = {t, *self.farther} | ({self.confirmed} if self.confirmed is not None else set())
        self.confirmed, *others = sorted(every)
        self.farther = tuple(others)

    @property
    def failing(self) -> list[float]:
        """Return each t that fails according to the evidence so far, in ascending order."""
        return sorted(t for t, one in self.evidence.items() if one.failing)

    @property
    def bracket(self) -> tuple[float, float] | None:
        """Return the nearest failing t and the measured t before it, or None if no t fails."""
        if not self.failing:
            return None
        far = self.failing[0]
        return max((t for t in self.evidence if t < far), default=0.0), far

    @property
    def boundary(self) -> Boundary | None:
        """Return the boundary, or None unless fresh seeds confirmed a failure."""
        if self.confirmed is None or self.bracket is None:
            return None
        near, far = self.bracket
        before = self.evidence[near].margin if near in self.evidence else 1.0
        share = before / (before - self.evidence[far].margin) if before > 0.0 else 0.0
        at = near + (far - near) * share if self.ray.continuous else far
        held = self.held if self.held is not None and self.held < self.confirmed else None
        return Boundary(min(max(at, held or 0.0), self.confirmed), held, self.confirmed, self.monotone)

    @property
    def monotone(self) -> bool:
        """Return whether all measured points beyond the nearest failing one also fail."""
        nearest = self.failing[0] if self.failing else 1.0
        return not any(t > nearest and not one.failing for t, one in self.evidence.items())


@dataclass(frozen=True, slots=True)
class Boundary:
    """The boundary on a ray: the guarantee holds up to `near` and fails at `far`; `at` is the estimate.

    If the margin never rises with the drift, the boundary lies between `near` and `far` with confidence CONFIDENCE.
    `near` is None if only the nominal value is known to hold.
    """

    at: float
    near: float | None
    far: float
    monotone: bool


@dataclass(frozen=True)
class Failure:
    """A drift that was confirmed on fresh seeds to break the guarantee."""

    point: Point
    distance: float
    names: tuple[str, ...]  # directions whose value is not nominal


@dataclass(frozen=True)
class MarginMap:
    """The predicted margins over two ranges, with their standard deviations.

    The cells divide both ranges evenly, and each value is predicted for the middle of its cell. Row i belongs to the
    i-th cell of the second range, in ascending order.
    """

    names: tuple[str, str]
    spans: tuple[Span, Span]
    margins: tuple[tuple[float, ...], ...]
    spreads: tuple[tuple[float, ...], ...]


@dataclass(frozen=True, slots=True)
class Share:
    """The Sobol indices of a direction: its shares of the margin's variance over the space.

    `first` is the share of the direction alone; `total` also includes its combinations with other directions. The error
    of a share is half the width of its confidence interval.
    """

    name: str
    first: float
    first_error: float
    total: float
    total_error: float


@dataclass(frozen=True)
class Sobol:
    """The Sobol indices of all directions, and the number of episodes used.

    `hopeless` is true if every episode had the lowest possible margin. The indices then have no meaning.
    """

    episodes: int
    shares: tuple[Share, ...]
    hopeless: bool = False


@dataclass(frozen=True, slots=True)
class Executed:
    """A statement that ran in `failing` failing episodes and in no other episode."""

    path: str
    line: int
    text: str
    failing: int


@dataclass(frozen=True)
class Statements:
    """The statements that ran only in failing episodes, and how many failing and other episodes were compared."""

    failing: int
    others: int
    only: tuple[Executed, ...]


@dataclass(frozen=True, slots=True)
class Moved:
    """How a repair moves a boundary: in words, and as the values that hold and that fail.

    A value is None if neither was shown. Values of a single direction are numbers from its range. Values of a
    combination are distances from nominal.
    """

    name: str
    change: str
    before: str
    after: str
    held_before: float | None
    failed_before: float | None
    held_after: float | None
    failed_after: float | None


@dataclass(frozen=True, slots=True)
class Draws:
    """Episodes at random points of the whole space, with and without a repair."""

    episodes: int
    passed_before: int
    passed_after: int
    reward_before: float  # mean reward per episode
    reward_after: float
    success_at_least: float  # lower confidence bound of the success rate with the repair


@dataclass(frozen=True)
class Attempt:
    """A search for a repair in a region of drifts, and the effects of the accepted repair."""

    region: str
    told: str  # description of the repair, or reason why there is none
    accepted: bool = False
    patch: str | None = None  # None if there is no repair or it is withheld
    withheld: str = ""  # why the repair is withheld, or empty
    moved: tuple[Moved, ...] = ()
    draws: Draws | None = None


@dataclass(frozen=True)
class Stress:
    """The result of a stress run of one test and space."""

    test: str
    drift: str
    seed: int
    space: Space
    guarantee: Guarantee
    budget: int
    episodes: int
    curves: tuple[Curve, ...]
    combinations: tuple[Failure, ...] = ()
    expected: tuple[Failure, ...] = ()  # drifts that the model expects to fail, but that are not confirmed
    seconds: float | None = None  # time limit in seconds, if the budget is a time limit
    must_hold: Mapping[str, Sequence[Any]] = field(default_factory=dict)
    tried: int = 0  # number of combinations tried
    margin_map: MarginMap | None = None
    statements: Statements | None = None  # None if no failure was confirmed
    sobol: Sobol | None = None  # None if there were too few episodes or SALib is not installed
    repairs: tuple[Attempt, ...] | None = None  # None if no repair was requested
    ended: str = ""  # why the search ended early ("budget", "interrupted" or "nominal"), or empty

    @property
    def nearer(self) -> Failure | None:
        """Return the nearest unconfirmed drift that the model expects to fail.

        Return None if a confirmed failure is about as near, or nearer. Skip drifts of a single direction that has a
        boundary, because the boundary says more about that direction.
        """
        limit = min((one.distance for one in self.failures), default=inf)
        bounded = [one.ray for one in self.curves if one.boundary is not None]
        return next(
            (
                one
                for one in self.expected
                if one.distance < NEARER * limit and all(place_on(ray, one) is None for ray in bounded)
            ),
            None,
        )

    @property
    def failures(self) -> tuple[Failure, ...]:
        """Return the confirmed failing drifts, nearest first: the nearest along each ray, and the combinations."""
        return _sorted([*confirmed(self.curves), *self.combinations])

    @property
    def every_failure(self) -> tuple[Failure, ...]:
        """Return all confirmed failures, nearest first, including the farther ones along each single direction."""
        return _sorted([*self.failures, *farther(self.curves)])


def place_on(ray: Ray, one: Failure) -> float | None:
    """Return the position of a failure on the ray of a single direction, or None if it is not on the ray."""
    if one.names != ray.names or len(ray.names) != 1:
        return None
    (name,) = ray.names
    number, end, usual = one.point[name], ray.farthest[name], ray.space.nominal[name]
    towards = (number > usual) == (end > usual) if ray.continuous else number == end
    return one.distance / ray.length if towards else None


def failure(space: Space, point: Point) -> Failure:
    """Return the failure at a point, with its distance and directions."""
    names = tuple(name for name, number in point.items() if number != space.nominal[name])
    return Failure(point, distance(space, point), names)


def contains(space: Space, outer: Point, inner: Point) -> bool:
    """Return whether `inner` lies between nominal and `outer` in each direction."""
    return all(
        min(usual, outer[name]) <= inner[name] <= max(usual, outer[name])
        for name, usual in space.nominal.items()
    )


def confirmed(curves: Sequence[Curve]) -> list[Failure]:
    """Return the confirmed failing drifts along single directions."""
    return [
        failure(one.ray.space, one.ray.point(one.confirmed)) for one in curves if one.confirmed is not None
    ]


def farther(curves: Sequence[Curve]) -> list[Failure]:
    """Return the confirmed failing drifts beyond the nearest one on each ray.

    Each is at least APART times as far from nominal as the previous one.
    """
    found = []
    for one in curves:
        last = one.confirmed
        for t in one.farther:
            if last is not None and t >= APART * last:
                found.append(failure(one.ray.space, one.ray.point(t)))
                last = t
    return found


def _sorted(found: Sequence[Failure]) -> tuple[Failure, ...]:
    return tuple(sorted(found, key=lambda one: (one.distance, one.names)))
