"""Adjust the factors of a change that earns nearly enough on several seeds.

A joint search uses large steps and usually only one seed, so it finds only the good regions. The best point
(combination of factors) of a region often passes all missions but earns a few percent too little. A better point is
then more likely nearby than elsewhere. The same is true for a single constant whose range of good values is narrow.

If two constants compensate each other, the good points form a narrow ridge that is parallel to no axis. After each
round over the factors, all of them therefore move once more by the ratios by which they have moved with the present
step (a pattern move of Hooke & Jeeves 1961).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from math import inf
from statistics import fmean

ALMOST = 0.9  # a combination is adjusted only if it gains at least this share of the wanted gain
KNOWN = 3  # a combination is adjusted only if it has run on at least this number of seeds
SEEDS = 3  # number of seeds on which factors are compared
# ratios by which a factor is moved up or down; the second ratio is used after the first one no longer helps
STEPS = (1.2, 1.08)
FINE_STEPS = (1.08, 1.03, 1.01)  # ratios for a single change that passes its missions and earns nearly enough
SHARP_STEPS = (1.08, 1.03)  # ratios for a single constant that earns much on most seeds
MUCH = 0.7  # SHARP_STEPS applies to constants that gain at least this share of the wanted gain
EPISODES = 36  # number of episodes after which no further factor is tried
# a factor is dropped if, on the first seeds, it earns less than the best one by this share of the wanted gain
BEHIND = 0.05
# if moving several factors at once improves the mean total by less than this share of the wanted gain, they stay: on a
# plateau, further moves only lead to its edge
NOTICEABLE = 0.002

Factors = tuple[float, ...]
Earned = Callable[[Factors, int], float | None]


def polished(
    begin: Factors,
    earned: Earned,
    seeds: Sequence[int],
    wanted: float,
    steps: Sequence[float] = STEPS,
    enough: float = inf,
) -> Factors:
    """Return the factors with the highest mean total reward that pattern search from `begin` finds.

    `earned` takes factors and a seed and returns the total reward of the episode, or None to reject the factors.
    `wanted` is the gain that a repair must bring. The ascent ends at a mean total of `enough`.
    """
    search = _Ascent(earned, seeds[:SEEDS], BEHIND * wanted, enough, NOTICEABLE * wanted)
    first = search.mean(begin, -inf)
    if first is None:
        return begin
    best, most = begin, first
    for step in steps:
        before, base = -inf, best
        while before < most < enough:
            before = most
            for at in range(len(begin)):
                best, most = search.along(best, most, at, step)
            best, most = search.onwards(base, best, most)
    return best


class _Ascent:
    def __init__(
        self, earned: Earned, seeds: Sequence[int], behind: float, enough: float, noticeable: float
    ) -> None:
        self.enough = enough
        self.noticeable = noticeable
        self.earned = earned
        self.seeds = seeds
        self.behind = behind
        self.spent = 0
        self._means: dict[Factors, float | None] = {}

    def along(self, best: Factors, most: float, at: int, step: float) -> tuple[Factors, float]:
        """Move one factor up, or else down, while the mean total grows; return factors and total."""
        for ratio in (step, 1.0 / step):
            begun = most
            while self.spent < EPISODES and most < self.enough:
                moved = (*best[:at], round(best[at] * ratio, 4), *best[at + 1 :])
                found = self.mean(moved, most)
                if found is None or found <= most:
                    break
                best, most = moved, found
            if most > begun:
                break
        return best, most

    def onwards(self, base: Factors, best: Factors, most: float) -> tuple[Factors, float]:
        """If `best` differs from `base` in several factors, repeat this move while the mean total grows noticeably."""
        ratios = [new / old if old else 1.0 for old, new in zip(base, best, strict=True)]
        if sum(ratio != 1.0 for ratio in ratios) < 2:
            return best, most
        while self.spent < EPISODES and most < self.enough:
            moved = tuple(round(one * ratio, 4) for one, ratio in zip(best, ratios, strict=True))
            found = self.mean(moved, most)
            if found is None or found < most + self.noticeable:
                break
            best, most = moved, found
        return best, most

    def mean(self, factors: Factors, most: float) -> float | None:
        """Return the mean total, or None if the factors are rejected or soon earn clearly less than `most`."""
        if factors not in self._means:
            self._means[factors] = self._run(factors, most)
        return self._means[factors]

    def _run(self, factors: Factors, most: float) -> float | None:
        totals: list[float] = []
        for seed in self.seeds:
            self.spent += 1
            total = self.earned(factors, seed)
            if total is None:
                return None
            totals.append(total)
            if fmean(totals) < most - self.behind:
                return None
        return fmean(totals)
