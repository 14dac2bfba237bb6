"""Drifts whose size varies by episode: a repair must work in every part of the range."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import chain, count
from statistics import fmean

from pytest_tarl import seeds
from pytest_tarl.drifts import sizes
from pytest_tarl.model import Band, Sizes
from pytest_tarl.repairing.request import Order
from pytest_tarl.searching.accept import TOO_LITTLE, Acceptance, Outcome

# a note says that a candidate works in a part of the range only after this number of successful episodes
LEAST_NEAR = 2

# number of strata (parts of the range); the number of episodes at each interim test is a multiple of it
STRATA = 4

Test = Callable[[Sequence[int]], Acceptance]  # tests a candidate on the given seeds


@dataclass(frozen=True)
class Ranged:
    """The seeds of a test in order, and the parts of the range in which the candidate passed or lost."""

    seeds: tuple[int, ...] = ()
    held: tuple[Band, ...] = ()
    lost: tuple[Band, ...] = ()


def over_the_range(order: Order, stream: str, most: int, test: Test) -> tuple[Acceptance, Ranged]:
    """Test a candidate once; if the drift has a range, spread the seeds evenly over it.

    Each block of `STRATA` episodes has one episode from each stratum of the range. Therefore, the test needs no more
    episodes than for a drift of a single size. The bound on the risk remains valid for two reasons. First, a fixed bet
    is not expected to grow more over a block than with episodes from random strata (inequality of arithmetic and
    geometric means). Second, if strata have different failure rates, a small number of failures is less likely than in
    a binomial distribution with the mean rate (Hoeffding 1956). In addition, an accepted candidate must lose less than
    the margin on average in each third of the range; this check can only turn an acceptance into a refusal.
    """
    bands = [band for one in order.comparison.sizes.values() for band in one.bands]
    if not bands:
        return test(seeds.episode_seeds(order.options.seed, stream, most)), Ranged()
    found = test(spread_seeds(order, stream, most))
    held = tuple(band for band in bands if _holds_in(order, band, found))
    lost = tuple(band for band in bands if band not in held)
    if lost and (found.accepted or (held and found.reason in TOO_LITTLE)):
        found = replace(found, accepted=False, reason="not over the whole range")
    return found, Ranged(found.seeds, held, lost)


def spread_seeds(order: Order, stream: str, most: int) -> tuple[int, ...]:
    """Return fresh seeds, ordered so that each block of `STRATA` seeds has one from each stratum."""
    strata: list[list[int]] = [[] for _ in range(STRATA)]
    wanted = -(-most // STRATA)
    for index in count():
        seed = seeds.episode_seed(order.options.seed, stream, index)
        stratum = strata[_stratum(order, seed)]
        if len(stratum) < wanted:
            stratum.append(seed)
        if all(len(one) == wanted for one in strata):
            break
    return tuple(chain.from_iterable(zip(*strata, strict=True)))[:most]


def _stratum(order: Order, seed: int) -> int:
    """Return a seed's stratum: a quarter of the range, or a pair of halves of two ranges."""
    drawn = _drawn(order, seed)
    first = list(order.comparison.sizes.items())[:2]
    each = STRATA if len(first) == 1 else 2
    number = 0
    for part, one in first:
        share = (drawn[part] - one.low) / (one.high - one.low)
        number = number * each + min(int(share * each), each - 1)
    return number


def _holds_in(order: Order, band: Band, found: Acceptance) -> bool:
    """Return whether a candidate loses at most the margin, on average, in a part of the range."""
    lost = [
        designed - outcome.total
        for seed, outcome, designed in zip(found.seeds, found.drifted, found.designed, strict=True)
        if band.low <= _drawn(order, seed)[band.part] <= band.high
    ]
    return bool(lost) and fmean(lost) <= order.reference.margin


def repaired_sizes(order: Order, ranged: Ranged) -> Mapping[str, Sizes]:
    """Return the drift sizes of the comparison together with those of the repair's acceptance test."""
    drawn = [_drawn(order, seed) for seed in ranged.seeds]
    return {
        part: replace(one, of={**one.of, "repaired": tuple(each[part] for each in drawn)})
        for part, one in order.comparison.sizes.items()
    }


def fits_a_part(order: Order, runs: Mapping[int, Outcome]) -> str:
    """If a candidate passed only at one end of a range of sizes, describe where; else return ""."""
    for part in order.comparison.sizes:
        near = [_drawn(order, seed)[part] for seed, run in runs.items() if order.goal.reached(run, seed)]
        far = [_drawn(order, seed)[part] for seed, run in runs.items() if not order.goal.reached(run, seed)]
        if len(near) >= LEAST_NEAR and far and (max(near) < min(far) or max(far) < min(near)):
            name = f" of {part}" if part else ""
            missed = f"{min(far):.3g} to {max(far):.3g}"
            return f"it works for sizes{name} from {min(near):.3g} to {max(near):.3g}, but not for {missed}"
    return ""


def bands_in_words(ranged: Ranged) -> str:
    """Describe the parts of the range in which a candidate passed."""
    held, lost = (" and ".join(map(str, bands)) for bands in (ranged.held, ranged.lost))
    return (
        f"it works for {held}, but not for {lost}" if held else f"it works in no part of the range ({lost})"
    )


def _drawn(order: Order, seed: int) -> Mapping[str, float]:
    if order.world is None or order.drift is None:
        return {}
    return sizes(order.world, order.drift, seed)
