"""Show the reward by drift size, as text and as a drawing."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from statistics import fmean

from pytest_tarl.model import Band, Comparison, Sizes
from pytest_tarl.report import amounts

WORLDS = ("online", "repaired")  # drifted world without and with the repair
WIDTH, HEIGHT = 640, 240  # px, without margins


@dataclass(frozen=True)
class Row:
    """The mean rewards in one interval of a range; None if it has no episodes."""

    band: Band
    before: float | None
    after: float | None
    episodes: tuple[int, int]


@dataclass(frozen=True)
class Plot:
    """The drawing for one range, with points in pixels and labelled ticks."""

    part: str
    points: Mapping[str, tuple[tuple[float, float], ...]]
    across: tuple[tuple[float, str], ...]
    up: tuple[tuple[float, str], ...]
    offline: float  # y coordinate of the designed world's mean reward, in pixels
    rows: tuple[Row, ...]


def rows(comparison: Comparison) -> Iterator[Row]:
    """Yield every interval of every range with its rewards."""
    for one in comparison.sizes.values():
        for band in one.bands:
            earned = [_within(comparison, one, band, world) for world in WORLDS]
            means = [fmean(totals) if totals else None for totals in earned]
            yield Row(band, means[0], means[1], (len(earned[0]), len(earned[1])))


def lines(comparison: Comparison) -> Iterator[str]:
    """Yield the mean reward in each interval of the range, as `before → after`."""
    repaired = bool(comparison.totals.get("repaired"))
    for row in rows(comparison):
        after = f" → {amounts.amount(row.after)} repaired" if repaired else ""
        yield f"{row.band}: {amounts.amount(row.before)}{after}"


def plots(comparison: Comparison) -> list[Plot]:
    """Return a drawing for every range."""
    found = list(rows(comparison))
    return [
        _plot(comparison, one, tuple(row for row in found if row.band.part == one.part))
        for one in comparison.sizes.values()
    ]


def _within(comparison: Comparison, one: Sizes, band: Band, world: str) -> list[float]:
    pairs = zip(one.of.get(world, ()), comparison.totals.get(world, ()), strict=False)
    last = band.high == one.high
    return [total for size, total in pairs if band.low <= size and (size < band.high or last)]


def _plot(comparison: Comparison, one: Sizes, found: tuple[Row, ...]) -> Plot:
    offline = amounts.atr(comparison, "offline") or 0.0
    totals = [offline, *(total for world in WORLDS for total in comparison.totals.get(world, ()))]
    low, high = min(totals), max(totals)
    room = (high - low) or 1.0

    def height(total: float) -> float:
        return round(HEIGHT * (high - total) / room, 1)

    def across(size: float) -> float:
        return round(WIDTH * (size - one.low) / (one.high - one.low), 1)

    points = {
        world: tuple(
            (across(size), height(total))
            for size, total in zip(one.of.get(world, ()), comparison.totals.get(world, ()), strict=False)
        )
        for world in WORLDS
    }
    ends = [one.low, *(band.high for band in one.bands)]
    return Plot(
        one.part,
        points,
        tuple((across(end), f"{end:.3g}") for end in ends),
        tuple((height(value), amounts.amount(value)) for value in sorted({low, offline, high})),
        height(offline),
        found,
    )
