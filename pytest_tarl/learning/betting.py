"""Test by betting whether a mean is above a limit (Waudby-Smith & Ramdas 2023).

Each episode is a bet against the claim that it is not. If the claim is true, a bet that always stakes a fixed share of
its wealth ever multiplies it by 1/risk with probability at most `risk`, for any distribution of totals and any number
of looks (Ville). Two bets share the wealth: a bold one, which wins soon if no episode is bad, and a careful one, which
survives a few bad ones. Any mixture of such bets keeps the risk.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import exp, inf, log, log1p
from statistics import fmean, variance

from pytest_tarl.learning.bounds import mean_of

BOLD, CAREFUL = 0.95, 0.5  # shares lost in the worst possible episode
OF_BOLD = 0.9  # share of the wealth that the bold bet begins with: of 200 repairs that lose 3 % and never fail, 197 are
# shown to be right, where half of the wealth shows 93; those that fail seldom are shown as often
DOUBT = 1.5  # factor on the variance estimated from few episodes
CERTAIN = 0.005  # approximate risk of refusing early although the mean is above the limit


@dataclass(frozen=True, slots=True)
class Bet:
    """Bets that the mean difference is above `-margin`; smaller differences than `least` are raised to it.

    `stakes` are per unit of reward.
    """

    margin: float
    least: float
    stakes: tuple[float, ...]

    @property
    def shares(self) -> tuple[float, ...]:
        """Return the share of the wealth that each stake begins with."""
        return (OF_BOLD, 1.0 - OF_BOLD) if len(self.stakes) > 1 else (1.0,)

    def wealth(self, differences: Sequence[float]) -> float:
        """Return the logarithm of the wealth that started as 1; -inf if all was lost."""
        each = [_grown(stake, differences, self.margin, self.least) for stake in self.stakes]
        most = max(each)
        if most == -inf:
            return most
        return most + log(sum(share * exp(one - most) for share, one in zip(self.shares, each, strict=True)))

    def powerless(self, episodes: int, risk: float) -> bool:
        """Return whether the bet cannot be won even if so many episodes lose nothing."""
        return self.wealth([0.0] * episodes) < -log(risk)

    def hopeless(self, differences: Sequence[float], left: int, risk: float) -> bool:
        """Return whether the bet cannot be won with `left` more episodes, even at an optimistic mean."""
        counted = [max(one, self.least) for one in differences]
        best = mean_of(counted, 1.0 - CERTAIN).high
        if best < -self.margin:
            return True
        growing = [log1p(stake * (max(best, 0.0) + self.margin)) for stake in self.stakes]
        return self.wealth(differences) + left * max(growing) < -log(risk)


def bet(margin: float, least: float, known: Sequence[float]) -> Bet:
    """Return bets that grow fast if differences are as in `known`, shape (episodes,), which the test must not reuse."""
    counted = [max(one, least) for one in known]
    spread = DOUBT * variance(counted) if len(counted) > 1 else 0.0
    gap = max(fmean(counted) + margin, margin / 4)
    wanted = gap / (spread + gap**2)
    stakes = (_bounded(wanted, margin, least, share) for share in (BOLD, CAREFUL))
    return Bet(margin, least, tuple(dict.fromkeys(stakes)))


def _grown(stake: float, differences: Sequence[float], margin: float, least: float) -> float:
    factors = [stake * (max(one, least) + margin) for one in differences]
    return sum(map(log1p, factors)) if all(factor > -1.0 for factor in factors) else -inf


def _bounded(stake: float, margin: float, least: float, share: float) -> float:
    """Return a stake that loses at most this share of the wealth in the worst episode."""
    deepest = -least - margin
    return stake if deepest <= 0.0 else min(stake, share / deepest)
