"""Which site is to blame: slices (Eq. 2) as a prior, effects that simulation confirmed as evidence."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

import numpy as np

from pytest_tarl.learning.tables import Floats, Ints
from pytest_tarl.model import Culprit, OperandEffect, SitePlace, Slice, TaintList


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


def prior(per_list: Iterable[Sequence[Slice]]) -> tuple[tuple[SitePlace, float], ...]:
    """Rank sites by the size of their slice difference, in (0, 1]; over several lists a site keeps its best rank."""
    best: dict[str, tuple[int, float, SitePlace]] = {}
    for ranked in per_list:
        ordered = sorted(ranked, key=lambda one: -abs(one.difference))
        largest = abs(ordered[0].difference) if ordered else 0.0
        for rank, one in enumerate(ordered):
            score = abs(one.difference) / largest if largest else 0.0
            if one.site.id not in best or (rank, -score) < (best[one.site.id][0], -best[one.site.id][1]):
                best[one.site.id] = (rank, score, one.site)
    order = sorted(best.values(), key=lambda entry: (entry[0], -entry[1], entry[2].path, entry[2].line))
    return tuple((site, score) for _, score, site in order)


def culprits(
    ranked: Sequence[tuple[SitePlace, float]],
    effects: Mapping[str, Sequence[OperandEffect]],
    repaired: Sequence[str],
    loss: float,
    method: str = "sweep",
) -> tuple[Culprit, ...]:
    """Rank sites: those of the confirmed repair, then by simulated effect, then by slice.

    `effects` maps site ids to what simulation by `method` found; `loss` (reward per episode) is an effect of score 1.
    """
    found = [_simulated(site, effects[site.id], loss, method) for site, _ in ranked if effects.get(site.id)]
    guessed = [Culprit(site, 0.0, "slices") for site, _ in ranked if not effects.get(site.id)]
    if not found:
        return tuple(Culprit(site, round(score, 4), "slices") for site, score in ranked)
    found.sort(key=lambda culprit: (culprit.site.id not in repaired, -culprit.score))
    return (*found, *guessed)


def _simulated(site: SitePlace, effects: Sequence[OperandEffect], loss: float, method: str) -> Culprit:
    ordered = tuple(sorted(effects, key=lambda effect: -effect.effect))
    score = max(0.0, min(1.0, ordered[0].effect / loss)) if loss > 0 else 0.0
    return Culprit(site, round(score, 4), method, ordered)
