"""Which site is to blame: slices (Eq. 2) as a prior, effects that simulation confirmed as evidence."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import replace

import numpy as np

from pytest_tarl.learning.packing import ROUNDING
from pytest_tarl.learning.tables import Floats, Ints
from pytest_tarl.model import Culprit, OperandEffect, SitePlace, Slice, TaintList

BELOW = 0.49  # the highest score of a site without an operand, where others have one


def slices(taint_list: TaintList, offline: Floats, online: Floats, region: Ints) -> tuple[Slice, ...]:
    """Sum each site's utility over the region (Eq. 2); inputs have shape (cells, sites).

    Only cells that both worlds have visited at that site count.
    """
    both = ~np.isnan(offline[region]) & ~np.isnan(online[region])
    before = np.where(both, offline[region], 0.0).sum(axis=0)
    after = np.where(both, online[region], 0.0).sum(axis=0)
    return tuple(
        Slice(site, taint_list.name, float(before[n]), float(after[n]))
        for n, site in enumerate(taint_list.sites)
    )


def prior(
    per_list: Iterable[Sequence[Slice]], changeable: Collection[str] | None = None
) -> tuple[tuple[SitePlace, float], ...]:
    """Rank sites by their score, the size of their slice difference as a share of the largest one of a taint list.

    Of several lists a site has its best score; one that does not differ is left out. `changeable` are the ids of the
    sites that hold an operand: their scores lie above a half and all others below, since nothing can be changed there.
    """
    best: dict[str, tuple[float, SitePlace]] = {}
    for ranked in per_list:
        sizes = [_difference(one) for one in ranked]
        largest = max(sizes, default=0.0)
        for one, size in zip(ranked, sizes, strict=True):
            if size > 0 and size / largest > best.get(one.site.id, (0.0, one.site))[0]:
                best[one.site.id] = (size / largest, one.site)
    scored = [(site, _banded(score, site, changeable)) for score, site in best.values()]
    return tuple(sorted(scored, key=lambda entry: (-entry[1], entry[0].path, entry[0].line, entry[0].id)))


def _difference(one: Slice) -> float:
    """Return the size of a slice's difference, 0 where rounding makes as much of equal ones, or one is unknown."""
    size = abs(one.difference)
    return size if size > 4 * ROUNDING * (abs(one.offline) + abs(one.online)) else 0.0


def _banded(score: float, site: SitePlace, changeable: Collection[str] | None) -> float:
    if changeable is None:
        return score
    return (1.0 + score) / 2 if site.id in changeable else BELOW * score


def culprits(
    ranked: Sequence[tuple[SitePlace, float]],
    effects: Mapping[str, Sequence[OperandEffect]],
    repaired: Sequence[str],
    loss: float,
    method: str = "sweep",
) -> tuple[Culprit, ...]:
    """Rank sites by their score: that of what simulation by `method` found, or of their slices where it found nothing.

    `effects` maps site ids to what was found; an effect of `loss` (reward per episode) has the score 1. A site of the
    confirmed repair has no lower score than any other, what was not simulated none.
    """
    found = [_simulated(site, effects[site.id], loss, method) for site, _ in ranked if effects.get(site.id)]
    guessed = [Culprit(site, 0.0, "slices") for site, _ in ranked if not effects.get(site.id)]
    if not found:
        scored = ((site, round(score, 4)) for site, score in ranked)
        return tuple(Culprit(site, score, "slices") for site, score in scored if score > 0)
    highest = max(one.score for one in found)
    found = [replace(one, score=highest) if one.site.id in repaired else one for one in found]
    found.sort(key=lambda culprit: (-culprit.score, culprit.site.id not in repaired))
    return (*found, *guessed)


def _simulated(site: SitePlace, effects: Sequence[OperandEffect], loss: float, method: str) -> Culprit:
    ordered = tuple(sorted(effects, key=lambda effect: -effect.effect))
    score = max(0.0, min(1.0, ordered[0].effect / loss)) if loss > 0 else 0.0
    return Culprit(site, round(score, 4), method, ordered)
