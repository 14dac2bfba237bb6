"""Regions in which to search for a repair: from a confirmed failure to the ends of its directions."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from pytest_tarl.drifts import Drift
from pytest_tarl.spaces import Choice, Point, Space, Span, nominal
from pytest_tarl.stressing.findings import Failure
from pytest_tarl.stressing.rays import Ray
from pytest_tarl.stressing.words import shown

# size of the region in each attempt, as a share of the way from the failure to the ends of the ranges
REACH = (1.0, 0.25)


@dataclass(frozen=True)
class Region:
    """The drifts beyond a failure; `words` describe them.

    Each episode draws the values of `drift` at random and takes all others from `base`.
    """

    base: Point
    drift: Drift
    words: str


def regions(space: Space, failed: Failure) -> Iterator[Region]:
    """Yield the regions beyond a failure, widest first; each covers the same share of what is left of every range."""
    for reach in REACH:
        spans: dict[str, Span | Choice] = {}
        words = []
        for name in failed.names:
            extent, near = space.extents[name], failed.point[name]
            far = near + (end(extent, near) - near) * reach
            if isinstance(extent, Span) and near != far:
                spans[name] = Span(min(near, far), max(near, far), near)
                words.append(f"{name} from {near:.3g} to {far:.3g}")
            else:
                words.append(f"{name}={shown(extent, near)}")
        value = Space(spans, {}) if spans else _fixed(space, failed)
        yield Region(failed.point, Drift(value), " and ".join(words))
        if not spans:
            return


def end(extent: Span | Choice, number: float) -> float:
    """Return the end of a range on the side of a number; for an option, return the number itself."""
    if isinstance(extent, Choice):
        return number
    return extent.high if number > nominal(extent) else extent.low


def outwards(space: Space, failed: Failure) -> Ray:
    """Return the ray from nominal through a failure to the edge of the space."""
    reached = []
    for name in failed.names:
        extent, usual = space.extents[name], space.nominal[name]
        if isinstance(extent, Span):
            reached.append((failed.point[name] - usual) / (end(extent, failed.point[name]) - usual))
    grow = max(reached, default=1.0)
    farthest = {
        name: number if isinstance(space.extents[name], Choice) else usual + (number - usual) / grow
        for (name, number), usual in zip(failed.point.items(), space.nominal.values(), strict=True)
    }
    return Ray(space, failed.names, farthest)


def _fixed(space: Space, failed: Failure) -> object:
    """Return the value that describes a region in which nothing varies.

    It is the value of the failing direction, or a tuple of values if several directions fail together.
    """
    values = []
    for name in failed.names:
        extent, number = space.extents[name], failed.point[name]
        values.append(extent.options[int(number)] if isinstance(extent, Choice) else number)
    return values[0] if len(values) == 1 else tuple(values)
