"""Repair a node for drifts at and beyond the failure boundary of a stress run, and show how far it moved.

A confirmed failure is a point of the drift space. The episodes of the search and of the acceptance test draw each
failing direction between this point and the end of its range; all other directions stay nominal. If no repair is
accepted in this region, the search tries a smaller one next to the boundary. An accepted repair is then run on fresh
draws from the whole declared space. It is withheld if it loses reward or successes there, or if it moves any boundary
nearer to nominal.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path

from pytest_tarl.comparing import run_online
from pytest_tarl.drifts import drawn_point, sizes
from pytest_tarl.instrumentation.sites import Plan
from pytest_tarl.learning.bounds import Range, mean_of, rate
from pytest_tarl.model import Repair
from pytest_tarl.repairing.mutants import Mutants
from pytest_tarl.repairing.repair import repair
from pytest_tarl.repairing.request import Neighbour, Order
from pytest_tarl.report.repair_words import refusal, repair_words
from pytest_tarl.rollout import EpisodePlan, EpisodeRun, Pending, Rollout, in_order
from pytest_tarl.seeds import episode_seeds
from pytest_tarl.spaces import Point, Space
from pytest_tarl.stressing.findings import Attempt, Draws, Failure, Moved, Stress
from pytest_tarl.stressing.guarantee import Outcome, outcome
from pytest_tarl.stressing.margin_changes import Row, compared
from pytest_tarl.stressing.margins import Margin, margins
from pytest_tarl.stressing.regions import Region, outwards, regions
from pytest_tarl.stressing.stress_run import Request, along, stress
from pytest_tarl.stressing.words import repair_lines
from tarl_lint.api import Analysis

DIRECTIONS = 2  # maximum number of failures to repair along one direction: the nearest
COMBINATIONS = 1  # maximum number of failures to repair in which several directions differ from nominal
DRAWS = 60  # fresh draws from the whole space
CONFIDENCE = 0.95  # confidence of the one-sided bounds that decide whether a repair loses reward or successes


@dataclass(frozen=True)
class Job:
    """The stressed test and the inputs of a repair; the rollout in `request` runs instrumented nodes."""

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
    """A rollout that runs each episode at point `place(seed)` of a space, with the files of `overlay` replaced."""

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
    """The effect of an accepted repair: changed margins, and outcomes in the space without and with it."""

    rows: tuple[Row, ...]
    before: tuple[Outcome, ...]
    after: tuple[Outcome, ...]
    combination: Moved | None = None

    @property
    def loses(self) -> str:
        """Return why the repair must be withheld, or an empty text."""
        fragile = [row.name for row in self.rows if row.change == "more fragile"]
        if fragile:
            return f"the boundary of {' and '.join(fragile)} moved nearer to the nominal point"
        pairs = [*zip(self.before, self.after, strict=True)]
        lost = [one.total - other.total for one, other in pairs]
        if mean_of(lost, CONFIDENCE).low > 0.0:
            return f"it loses {sum(lost) / len(lost):.3g} per episode over the declared space"
        failed = [float(one.passed) - float(other.passed) for one, other in pairs]
        if mean_of(failed, CONFIDENCE, Range(-1.0, 1.0)).low > 0.0:
            return (
                f"of {len(failed)} draws from the declared space, {sum(failed):.0f} more fail with the repair than "
                "without it"
            )
        return ""

    @property
    def moved(self) -> tuple[Moved, ...]:
        """Return each boundary before and after the repair, that of a combination of directions first."""
        first = () if self.combination is None else (self.combination,)
        return (*first, *(_moved(row) for row in self.rows))

    @property
    def draws(self) -> Draws:
        """Summarise the outcomes over the space: successes and mean rewards before and after the repair."""
        passed = [sum(one.passed for one in world) for world in (self.before, self.after)]
        earned = [sum(one.total for one in world) / len(world) for world in (self.before, self.after)]
        surely = rate(passed[1], len(self.after), CONFIDENCE).low
        return Draws(len(self.after), passed[0], passed[1], earned[0], earned[1], surely)


@dataclass(frozen=True)
class Told:
    """The repair searches, the lines of the report, and the patch."""

    lines: tuple[str, ...]
    patch: Path | None = None
    interrupted: bool = False
    fixed: Fixed | None = None
    attempts: tuple[Attempt, ...] = ()


def repair_boundary(job: Job, found: Stress) -> Told:
    """Try to repair the failures, nearest first, until one repair is accepted. Raise RepairError, RecordingError."""
    attempts: list[Attempt] = []
    for failed in chosen(found.failures):
        for region in regions(found.space, failed):
            try:
                accepted, overlay, why = _searched(job, region)
            except KeyboardInterrupt:
                attempts.append(Attempt(region.words, "interrupted."))
                return _finished(found, attempts, interrupted=True)
            if accepted is not None:
                return _told(job, found, failed, region, accepted, overlay, attempts)
            attempts.append(Attempt(region.words, why))
    return _finished(found, attempts)


def chosen(failures: Sequence[Failure]) -> list[Failure]:
    """Return the failures to repair, nearest first."""
    single = [one for one in failures if len(one.names) == 1][:DIRECTIONS]
    several = [one for one in failures if len(one.names) > 1][:COMBINATIONS]
    return [one for one in failures if one in (*single, *several)]


def _told(
    job: Job,
    found: Stress,
    failed: Failure,
    region: Region,
    accepted: Repair,
    overlay: Mapping[Path, str],
    attempts: list[Attempt],
) -> Told:
    """Test an accepted repair over the whole space; if it is withheld, delete its patch."""
    patch = job.root / accepted.patch
    attempt = Attempt(region.words, repair_words(accepted), accepted=True, patch=accepted.patch)
    try:
        fixed = _examined(job, found, failed, overlay)
    except KeyboardInterrupt:
        unknown = f"{attempt.told}; interrupted before it was tested over the declared space."
        attempts.append(replace(attempt, told=unknown))
        return _finished(found, attempts, patch, interrupted=True)
    if fixed.loses:
        with suppress(OSError):
            patch.unlink()
    kept = None if fixed.loses else accepted.patch
    attempts.append(replace(attempt, patch=kept, withheld=fixed.loses, moved=fixed.moved, draws=fixed.draws))
    return replace(_finished(found, attempts, None if fixed.loses else patch), fixed=fixed)


def _finished(
    found: Stress, attempts: Sequence[Attempt], patch: Path | None = None, *, interrupted: bool = False
) -> Told:
    sentences = repair_lines(replace(found, repairs=tuple(attempts)))
    lines = (f"  {'repair' if not number else '':10} {one}" for number, one in enumerate(sentences))
    return Told(tuple(lines), patch, interrupted, attempts=tuple(attempts))


def _searched(job: Job, region: Region) -> tuple[Repair | None, Mapping[Path, str], str]:
    """Search for a repair in a region. Return it with the files that it changes, and why none was accepted."""
    request = job.request
    drift, world = request.drift, region.drift

    def place(seed: int) -> Point:
        return {**region.base, **sizes(world, drift, seed)}

    rollout = Placed(request.rollout, drift, place)
    marked = replace(request.designation, drifts={**request.designation.drifts, drift: world})
    options = replace(request.options, mode="repair")
    online = run_online(
        rollout, request.fixture, marked, options, job.sites, drift, request.progress, job.changeable
    )
    if "reward" not in online.comparison.verdict.because:
        return None, {}, "no loss of reward was shown, so nothing is repaired."
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


def _examined(job: Job, found: Stress, failed: Failure, overlay: Mapping[Path, str]) -> Fixed:
    """Stress the repaired node along each direction, along the ray to the failure, and at random points."""
    request = job.request
    patched = Placed(request.rollout, request.drift, overlay=overlay)
    again = replace(request, rollout=patched, source=None)
    rows = compared([margins(found)], [margins(stress(again, combined=False))])
    return Fixed(
        tuple(rows),
        _over_space(job, found.space, request.rollout),
        _over_space(job, found.space, patched),
        _combination(again, found.space, failed) if len(failed.names) > 1 else None,
    )


def _combination(again: Request, space: Space, failed: Failure) -> Moved:
    """Return the boundary before and after the repair, on the ray from nominal through the failure."""
    curve = along(again, outwards(space, failed))
    length = curve.ray.length
    name = " and ".join(failed.names)
    sides = [
        Margin(name, 0.0, length, None if held is None else held * length, fails)
        for held, fails in (
            (None, failed.distance),
            (curve.held, None if curve.confirmed is None else curve.confirmed * length),
        )
    ]
    row = Row("", sides[0], sides[1])
    return replace(_moved(row), name=f"{name} together, distance")


def _moved(row: Row) -> Moved:
    values = [
        None if side is None else value
        for side in (row.before, row.after)
        for value in ((side.holds_to, side.fails_at) if side is not None else (None, None))
    ]
    return Moved(row.name, row.change, *row.cells, *values)


def _over_space(job: Job, space: Space, rollout: Rollout) -> tuple[Outcome, ...]:
    """Return the outcomes at DRAWS points of the whole space, the same points and seeds in every call."""
    request = job.request
    plans = (
        EpisodePlan(seed, request.drift, point=drawn_point(space, request.drift, seed))
        for seed in episode_seeds(request.options.seed, f"stress {request.drift} space", DRAWS)
    )
    return tuple(outcome(one.result()) for one in in_order(rollout, plans))
