"""`tarl diff A B`: compare two recordings of a test."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from pytest_tarl.learning.drift import outcomes, succeed_less
from pytest_tarl.learning.fixture import Fixture
from pytest_tarl.learning.permutation import permuted_decreases
from pytest_tarl.model import SitePlace
from pytest_tarl.report.guarantee_words import percent
from pytest_tarl.seeds import generator


@dataclass(frozen=True)
class Moved:
    """A site that moved to another line."""

    before: SitePlace
    after: SitePlace


@dataclass(frozen=True)
class FixtureDiff:
    """The changes.

    `loss` is A's mean reward per episode minus B's, with the p-value `p_loss`. `success` has the success rates of A and
    B, and `p_failures` is the p-value of a decrease. Both p-values are corrected for two tests.
    """

    loss: float
    p_loss: float
    success: tuple[float, float]
    gone: tuple[SitePlace, ...]
    new: tuple[SitePlace, ...]
    moved: tuple[Moved, ...]
    cells: tuple[int, int, int]  # number of cells only in A, in both, only in B
    same_sensors: bool
    p_failures: float = 1.0

    def worse(self, alpha: float, most: float = 0.0) -> bool:
        """Return whether B is significantly worse.

        B is worse if it earns less than A by more than `most` per episode, or if its success rate is lower by more than
        PASS_RATE_LOSS.
        """
        fail_more = self.p_failures < alpha and succeed_less(self.success)
        return (self.loss > most and self.p_loss < alpha) or fail_more

    @property
    def changed(self) -> bool:
        """Return whether any site was edited, added or removed, or the sensors differ."""
        return bool(self.gone or self.new) or not self.same_sensors


SIGNIFICANT = 0.05
MOST = 12  # maximum number of statements to list per kind


def compared(first: Fixture, second: Fixture) -> FixtureDiff:
    """Compare two recordings; the names of their tests may differ."""
    before, after = _sites(first), _sites(second)
    mine, theirs = set(first.sample.cells), set(second.sample.cells)
    a, b = first.sample, second.sample
    p_loss, p_failures = permuted_decreases(outcomes(a), outcomes(b), generator(0, "diff")).tolist()
    return FixtureDiff(
        loss=float(a.total.mean() - b.total.mean()),
        p_loss=p_loss,
        p_failures=p_failures,
        success=(float(a.passed.mean()), float(b.passed.mean())),
        gone=tuple(place for site, place in before.items() if site not in after),
        new=tuple(place for site, place in after.items() if site not in before),
        moved=tuple(
            Moved(place, after[site])
            for site, place in before.items()
            if site in after and (after[site].path, after[site].line) != (place.path, place.line)
        ),
        cells=(len(mine - theirs), len(mine & theirs), len(theirs - mine)),
        same_sensors=first.sensors == second.sensors,
    )


def lines(first: Fixture, second: Fixture, found: FixtureDiff) -> Iterator[str]:
    """Yield the lines that print a difference."""
    a, b = first.sample, second.sample
    yield f"{first.test} → {second.test}" if first.test != second.test else first.test
    yield f"  episodes   {a.episodes} → {b.episodes}"
    yield f"  reward     {a.total.mean():.4g} → {b.total.mean():.4g} per episode (less: p = {found.p_loss:.2g})"
    fewer = f" (less: p = {found.p_failures:.2g})" if found.success[1] < found.success[0] else ""
    yield f"  success    {percent(found.success[0])} → {percent(found.success[1])}{fewer}"
    if found.same_sensors:
        yield f"  cells      {found.cells[1]} in both, {found.cells[0]} gone, {found.cells[2]} new"
    else:
        yield "  cells      not comparable: the sensors differ"
    yield from _first(
        [
            f"  gone       `{_code(place)}` of {place.path}:{place.line}: its slice is lost; verdict and region "
            "remain valid"
            for place in found.gone
        ]
    )
    yield from _first(
        [
            f"  new        `{_code(place)}` at {place.path}:{place.line}: it has no slice in the first recording"
            for place in found.new
        ]
    )
    yield from _first(
        [
            f"  moved      `{_code(moved.before)}` from {_before(moved)} to {_place(moved)}: its slice is kept"
            for moved in found.moved
        ]
    )


def _first(rows: list[str]) -> Iterator[str]:
    """Yield the first MOST rows, then a line with the number of rows left out."""
    yield from rows[:MOST]
    if len(rows) > MOST:
        yield f"             … and {len(rows) - MOST} more"


def _place(moved: Moved) -> str:
    same_file = moved.before.path == moved.after.path
    return str(moved.after.line) if same_file else f"{moved.after.path}:{moved.after.line}"


def _before(moved: Moved) -> str:
    same_file = moved.before.path == moved.after.path
    return f"line {moved.before.line}" if same_file else f"{moved.before.path}:{moved.before.line}"


def _code(place: SitePlace) -> str:
    return " ".join(place.code.split())


def _sites(fixture: Fixture) -> dict[str, SitePlace]:
    return {site.id: site for one in fixture.lists for site in one.sites}
