"""Repair a node at the boundary that a stress run found and beyond, and show how far the boundary moved.

The episodes of search and acceptance draw the direction that fails first from its boundary to the end of its range; all
others are nominal. If nothing is accepted, a part of this range next to the boundary is tried. An accepted repair must
also hold over the whole declared space on fresh draws, and must not bring any boundary nearer.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path

from pytest_tarl.comparing import run_online
from pytest_tarl.drifts import Drift, drawn_point, sizes
from pytest_tarl.instrumentation.sites import Plan
from pytest_tarl.learning.bounds import mean_of
from pytest_tarl.model import Repair
from pytest_tarl.repairing.mutants import Mutants
from pytest_tarl.repairing.repair import repair
from pytest_tarl.repairing.request import Neighbour, Order
from pytest_tarl.report.repair_words import refusal, repair_words
from pytest_tarl.rollout import EpisodePlan, EpisodeRun, Pending, Rollout, in_order
from pytest_tarl.seeds import episode_seeds
from pytest_tarl.spaces import Choice, Point, Space, Span
from pytest_tarl.stressing.evaluating import outcome
from pytest_tarl.stressing.findings import Curve, Stress
from pytest_tarl.stressing.guarantee import Outcome
from pytest_tarl.stressing.margin_changes import Row, compared
from pytest_tarl.stressing.margins import margins
from pytest_tarl.stressing.search import Request, stress
from tarl_lint.api import Analysis

# shares of the way from the boundary to the end of the range that a repair is searched for
REACH = (1.0, 0.25)
DIRECTIONS = 2  # directions to repair at most, the nearest boundary first
DRAWS = 60  # fresh draws from the whole space
CONFIDENCE = 0.95  # that a repair which is said to lose over the space does


@dataclass(frozen=True)
class Job:
    """The stressed test, and what a repair needs of it; `request` has an instrumented rollout."""

    request: Request
    analysis: Analysis
    sites: Plan
    root: Path
    patches: Path
    recorded: Path | None
    neighbours: Callable[[], Sequence[Neighbour]]
    changeable: Collection[str]


@dataclass(frozen=True)
class Placed:
    """Run the episodes of a space at points that `place` chooses by seed, with changed files."""

    rollout: Rollout
    drift: str
    place: Callable[[int], Point] | None = None
    overlay: Mapping[Path, str] | None = None

    @property
    def workers(self) -> int:
        """Return the number of parallel episodes."""
        return self.rollout.workers

    def __call__(self, plan: EpisodePlan) -> EpisodeRun:
        """Run one episode."""
        return self.rollout(self._placed(plan))

    def begin(self, plan: EpisodePlan) -> Pending:
        """Request an episode without waiting for it."""
        return self.rollout.begin(self._placed(plan))

    def _placed(self, plan: EpisodePlan) -> EpisodePlan:
        changed = {**(self.overlay or {}), **plan.overlay}
        if self.place is None or plan.drift != self.drift or plan.point is not None:
            return replace(plan, overlay=changed)
        return replace(plan, overlay=changed, point=self.place(plan.seed))


@dataclass(frozen=True)
class Fixed:
    """What an accepted repair changes: margins, and outcomes over the space without and with it."""

    rows: tuple[Row, ...]
    before: tuple[Outcome, ...]
    after: tuple[Outcome, ...]

    @property
    def loses(self) -> str:
        """Return why the repair is withheld; else empty."""
        fragile = [row.name for row in self.rows if row.change == "more fragile"]
        if fragile:
            return f"the boundary of {' and '.join(fragile)} came nearer"
        lost = [one.total - other.total for one, other in zip(self.before, self.after, strict=True)]
        if mean_of(lost, CONFIDENCE).low > 0.0:
            return f"it loses {sum(lost) / len(lost):.3g} per episode over the declared space"
        return ""


@dataclass(frozen=True)
class Told:
    """The lines of a repair at the boundary, and its patch."""

    lines: tuple[str, ...]
    patch: Path | None = None
    interrupted: bool = False
    fixed: Fixed | None = None


def repair_boundary(job: Job, found: Stress) -> Told:
    """Repair at the nearest boundary that can be repaired. Raise RepairError or RecordingError."""
    failing = sorted(
        (curve for curve in found.curves if curve.confirmed is not None),
        key=lambda curve: (curve.confirmed or 0.0) * curve.ray.length,
    )
    lines: list[str] = []
    for curve in failing[:DIRECTIONS]:
        for world, where in _worlds(curve):
            head = f"  {'repair' if not lines else '':10} {where}:"
            try:
                accepted, overlay, why = _searched(job, curve, world)
            except KeyboardInterrupt:
                return Told((*lines, f"{head} interrupted."), interrupted=True)
            if accepted is not None:
                return _told(job, found, accepted, overlay, (*lines, f"{head} {repair_words(accepted)}"))
            lines.append(f"{head} {why}")
    return Told(tuple(lines))


def _told(
    job: Job, found: Stress, accepted: Repair, overlay: Mapping[Path, str], lines: tuple[str, ...]
) -> Told:
    """Examine an accepted repair; its patch stays if this is interrupted, and goes if it loses."""
    patch = job.root / accepted.patch
    try:
        fixed = _examined(job, found, overlay)
    except KeyboardInterrupt:
        unknown = f"  {'':10} Interrupted before it was tested over the declared space."
        return Told((*lines, unknown), patch, interrupted=True)
    if fixed.loses:
        with suppress(OSError):
            patch.unlink()
    return Told((*lines, *_words(fixed)), None if fixed.loses else patch, fixed=fixed)


def _worlds(curve: Curve) -> Iterator[tuple[Drift, str]]:
    """Yield the drifts to repair along a ray, widest first, and their words."""
    (name,), ray = curve.ray.names, curve.ray
    extent = ray.space.extents[name]
    if isinstance(extent, Choice):
        option = extent.options[int(ray.farthest[name])]
        yield Drift(option), f"{name}={option!r}"
        return
    start = curve.confirmed or 0.0
    for reach in REACH if start < 1.0 else (0.0,):
        near, far = ray.value(start), ray.value(start + (1.0 - start) * reach)
        low, high = sorted((near, far))
        if low == high:
            yield Drift(near), f"{name}={near:.3g}"
        else:
            yield Drift(Space({name: Span(low, high, near)}, {})), f"{name} from {near:.3g} to {far:.3g}"


def _searched(job: Job, curve: Curve, world: Drift) -> tuple[Repair | None, Mapping[Path, str], str]:
    """Compare and repair under a drift; return an accepted repair and its changed files, or why there is none."""
    request = job.request
    drift, start = request.drift, curve.confirmed or 0.0

    def place(seed: int) -> Point:
        return {**(curve.ray.point(start)), **sizes(world, drift, seed)}

    rollout = Placed(request.rollout, drift, place)
    marked = replace(request.designation, drifts={**request.designation.drifts, drift: world})
    options = replace(request.options, mode="repair")
    online = run_online(
        rollout, request.fixture, marked, options, job.sites, drift, request.progress, job.changeable
    )
    if online.comparison.verdict.result != "degraded":
        return None, {}, "no loss was shown, so nothing is repaired."
    order = Order(
        rollout,
        job.analysis,
        job.root,
        request.fixture,
        online,
        options,
        request.progress,
        job.patches,
        job.recorded,
        job.neighbours,
        world,
        marked.total_range,
    )
    done = repair(order)
    if done.interrupted:
        raise KeyboardInterrupt
    given = done.comparison.repair
    if given is None or done.accepted is None:
        return (
            None,
            {},
            f"none accepted: {refusal(given)}" if given is not None else "nothing to change was found",
        )
    return given, Mutants(order).source(done.accepted.candidate), ""


def _examined(job: Job, found: Stress, overlay: Mapping[Path, str]) -> Fixed:
    """Stress the repaired node along single directions, and run it over the whole space on fresh draws."""
    request = job.request
    patched = Placed(request.rollout, request.drift, overlay=overlay)
    after = stress(replace(request, rollout=patched, source=None), combined=False)
    rows = compared([margins(found)], [margins(after)])
    return Fixed(
        tuple(rows),
        _over_space(job, found.space, request.rollout),
        _over_space(job, found.space, patched),
    )


def _over_space(job: Job, space: Space, rollout: Rollout) -> tuple[Outcome, ...]:
    """Return the outcomes of fresh draws from the whole space."""
    request = job.request
    plans = (
        EpisodePlan(seed, request.drift, point=drawn_point(space, request.drift, seed))
        for seed in episode_seeds(request.options.seed, f"stress {request.drift} space", DRAWS)
    )
    return tuple(outcome(one.result()) for one in in_order(rollout, plans))


def _words(fixed: Fixed) -> Iterator[str]:
    """Yield the lines on what an accepted repair changes."""
    for row in fixed.rows:
        before, after = row.cells
        if before != after or row.change != "no significant change":
            yield f"  {'':10} {row.name}: {before} → {after}: {row.change}"
    usual, now = (sum(one.passed for one in world) for world in (fixed.before, fixed.after))
    earned, earns = (sum(one.total for one in world) / DRAWS for world in (fixed.before, fixed.after))
    yield (
        f"  {'':10} over the declared space: {now} instead of {usual} of {DRAWS} fresh draws pass, and each earns "
        f"{earns:.4g} instead of {earned:.4g}."
    )
    if fixed.loses:
        yield f"  {'':10} The repair is withheld, since {fixed.loses}."
