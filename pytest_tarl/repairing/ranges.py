"""A drift whose size differs from episode to episode: a repair has to hold in every part of the range."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import chain, count

from pytest_tarl import seeds
from pytest_tarl.drifts import sizes
from pytest_tarl.model import Band, Sizes
from pytest_tarl.repairing.order import Order
from pytest_tarl.searching.accept import TOO_LITTLE, Acceptance, Outcome

LEAST_NEAR = 2  # episodes that a candidate holds in before it is said to fit a part of the range

Test = Callable[
    [Sequence[int], bool], Acceptance
]  # of a candidate: on seeds, and in the designed world or not


@dataclass(frozen=True)
class Ranged:
    """The seeds of an acceptance in the order of its episodes, and the parts of the range in which it held or not."""

    seeds: tuple[int, ...] = ()
    held: tuple[Band, ...] = ()
    lost: tuple[Band, ...] = ()


def over_the_range(order: Order, stream: str, most: int, test: Test) -> tuple[Acceptance, Ranged]:
    """Test a candidate in each part of the range with fresh seeds of its own; at one go where the drift is a point.

    It is accepted where all parts accept it. Each part has the whole risk: a candidate that fails in one of them
    would have to be accepted there (intersection-union test, Berger 1982).
    """
    bands = [band for one in order.comparison.sizes.values() for band in one.bands]
    if not bands:
        return test(seeds.episode_seeds(order.options.seed, stream, most), True), Ranged()
    ended: list[tuple[Band, Acceptance]] = []
    used: list[int] = []
    for number, band in enumerate(bands):
        fresh = seeds_in(order, band, f"{stream} {number}", most)
        found = test(fresh, number == 0)
        used += found.seeds
        ended.append((band, found))
        if found.reason == "nominal gets worse":
            break
    held = tuple(band for band, found in ended if found.accepted)
    lost = tuple(band for band, found in ended if not found.accepted)
    return _joined([found for _, found in ended]), Ranged(tuple(used), held, lost)


def seeds_in(order: Order, band: Band, stream: str, most: int) -> tuple[int, ...]:
    """Return fresh seeds whose episodes draw a size from this part of the range."""
    found: list[int] = []
    for index in count():
        seed = seeds.episode_seed(order.options.seed, stream, index)
        if band.low <= _drawn(order, seed)[band.part] <= band.high:
            found.append(seed)
        if len(found) == most:
            return tuple(found)
    raise AssertionError("seeds do not end")


def repaired_sizes(order: Order, ranged: Ranged) -> Mapping[str, Sizes]:
    """Return the sizes of the comparison with those that the repair was accepted on."""
    drawn = [_drawn(order, seed) for seed in ranged.seeds]
    return {
        part: replace(one, of={**one.of, "repaired": tuple(each[part] for each in drawn)})
        for part, one in order.comparison.sizes.items()
    }


def fits_a_part(order: Order, runs: Mapping[int, Outcome]) -> str:
    """Say at which sizes a candidate held, where it did so at one end of a range only; else ""."""
    for part in order.comparison.sizes:
        near = [_drawn(order, seed)[part] for seed, run in runs.items() if order.goal.reached(run)]
        far = [_drawn(order, seed)[part] for seed, run in runs.items() if not order.goal.reached(run)]
        if len(near) >= LEAST_NEAR and far and (max(near) < min(far) or max(far) < min(near)):
            name = f" of {part}" if part else ""
            missed = f"{min(far):.3g} to {max(far):.3g}"
            return f"it fits sizes{name} from {min(near):.3g} to {max(near):.3g} and not {missed}"
    return ""


def bands_in_words(ranged: Ranged) -> str:
    """Say in which parts of the range a candidate held."""
    held, lost = (" and ".join(map(str, bands)) for bands in (ranged.held, ranged.lost))
    return (
        f"it holds for {held} and not for {lost}"
        if held
        else f"it holds for no part of the range, not for {lost}"
    )


def _drawn(order: Order, seed: int) -> Mapping[str, float]:
    if order.world is None or order.drift is None:
        return {}
    return sizes(order.world, order.drift, seed)


def _joined(parts: Sequence[Acceptance]) -> Acceptance:
    """Return what the tests of all parts come to."""
    refused = [part for part in parts if not part.accepted]
    split = refused and len(refused) < len(parts) and refused[0].reason in TOO_LITTLE
    return replace(
        parts[0],
        accepted=not refused,
        reason="not over the whole range" if split else refused[0].reason if refused else "",
        drifted=tuple(chain.from_iterable(part.drifted for part in parts)),
        tested=any(part.tested for part in parts),
        episodes=sum(part.episodes for part in parts),
        seeds=tuple(chain.from_iterable(part.seeds for part in parts)),
    )
