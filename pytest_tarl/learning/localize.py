"""Rank sites: the statements that may cause a loss.

A first ranking uses the slices of the paper's Eq. 2; effects measured in simulation then replace it.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import replace

import numpy as np

from pytest_tarl.learning.packing import ROUNDING
from pytest_tarl.learning.tables import Floats, Ints
from pytest_tarl.model import Culprit, OperandEffect, SitePlace, Slice, TaintList

BELOW = 0.49  # maximum score of sites that a repair cannot change, if there are others


def slices(taint_list: TaintList, offline: Floats, online: Floats, region: Ints) -> tuple[Slice, ...]:
    """Sum each site's utility over the region (Eq. 2); inputs have shape (cells, sites).

    A site's sum skips the cells in which the site was not visited in both worlds.
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
    """Rank sites by score: the difference of a site's slices, relative to the largest in its taint list.

    A site in several lists gets its best score. Sites without a difference are omitted. `changeable` has the ids of the
    sites with an operand that a repair can change. These get scores above 0.5, all others below 0.5.
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
    """Return the absolute difference of a slice; 0 if it is unknown or only a rounding error."""
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
    """Rank sites by their measured effects, or by their slices where no effect was measured.

    `effects` maps site ids to effects in reward per episode; an effect of size `loss` scores 1. The sites of the
    confirmed repair score highest, the one with the largest effect of its own first. Sites that were not tried in
    simulation score 0. Sites where no changed constant affected the reward come last.
    """
    found = [_simulated(site, effects[site.id], loss, method) for site, _ in ranked if effects.get(site.id)]
    guessed = [Culprit(site, 0.0, "slices") for site, _ in ranked if not effects.get(site.id)]
    if not found:
        scored = ((site, round(score, 4)) for site, score in ranked)
        return tuple(Culprit(site, score, "slices") for site, score in scored if score > 0)
    highest = max(one.score for one in found)
    found = [replace(one, score=highest) if one.site.id in repaired else one for one in found]
    found.sort(key=lambda one: (-one.score, one.site.id not in repaired, -_own(one)))
    idle = [
        one for one in found if one.site.id not in repaired and not any(each.effect for each in one.operands)
    ]
    return (*(one for one in found if one not in idle), *guessed, *idle)


def _own(culprit: Culprit) -> float:
    return max((effect.effect for effect in culprit.operands), default=0.0)


def _simulated(site: SitePlace, effects: Sequence[OperandEffect], loss: float, method: str) -> Culprit:
    ordered = tuple(sorted(effects, key=lambda effect: -effect.effect))
    score = max(0.0, min(1.0, ordered[0].effect / loss)) if loss > 0 else 0.0
    return Culprit(site, round(score, 4), method, ordered)
