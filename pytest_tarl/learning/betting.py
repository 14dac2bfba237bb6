"""Test by betting whether a mean is above a limit (Waudby-Smith & Ramdas 2023).

Each episode is a bet against the claim that the mean is at most the limit. A bettor stakes the same share of the wealth
each time. If the claim is true, the probability that the wealth ever reaches 1/risk times its initial value is at most
`risk`. This holds for any distribution of the values and any number of looks (Ville's inequality), and also for a
mixture of bets. Two bets share the wealth: a bold one wins early if no episode is bad, and a careful one survives a few
bad episodes.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import exp, inf, log, log1p
from statistics import fmean, variance

from pytest_tarl.learning.bounds import mean_of

# largest share of its wealth that the bold, or the careful, bet may lose in one episode
BOLD, CAREFUL = 0.95, 0.5
# Share of the initial wealth given to the bold bet. In a simulation of 200 correct repairs that lose 3 % of the reward
# and never fail, the test accepts 197 with a share of 0.9, and 93 with 0.5. For correct repairs that rarely fail, it
# accepts equally many with both shares.
OF_BOLD = 0.9
DOUBT = 1.5  # safety factor for the variance, which is estimated from few episodes
CERTAIN = 0.005  # approximate probability of stopping early although the mean is above the limit


@dataclass(frozen=True, slots=True)
class Bet:
    """Bets that the mean difference is above `-margin`.

    Differences below `least` count as `least`. `stakes` are the amounts staked per unit of reward.
    """

    margin: float
    least: float
    stakes: tuple[float, ...]

    @property
    def shares(self) -> tuple[float, ...]:
        """Return the share of the initial wealth that each stake gets."""
        return (OF_BOLD, 1.0 - OF_BOLD) if len(self.stakes) > 1 else (1.0,)

    def wealth(self, differences: Sequence[float]) -> float:
        """Return the log of the wealth, which starts at 1; -inf if everything is lost."""
        each = [_grown(stake, differences, self.margin, self.least) for stake in self.stakes]
        most = max(each)
        if most == -inf:
            return most
        return most + log(sum(share * exp(one - most) for share, one in zip(self.shares, each, strict=True)))

    def powerless(self, episodes: int, risk: float) -> bool:
        """Return whether the bets cannot win even if `episodes` episodes all have a difference of 0."""
        return self.wealth([0.0] * episodes) < -log(risk)

    def hopeless(self, differences: Sequence[float], left: int, risk: float) -> bool:
        """Return whether the bets are unlikely to win with `left` more episodes, even at an optimistic mean."""
        counted = [max(one, self.least) for one in differences]
        best = mean_of(counted, 1.0 - CERTAIN).high
        if best < -self.margin:
            return True
        growing = [log1p(stake * (max(best, 0.0) + self.margin)) for stake in self.stakes]
        return self.wealth(differences) + left * max(growing) < -log(risk)


def bet(margin: float, least: float, known: Sequence[float]) -> Bet:
    """Return bets that grow fast if future differences are like `known`, shape (episodes,).

    The test must not use the differences in `known`, because the stakes depend on them.
    """
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
    """Return the stake, limited so that one episode loses at most `share` of the wealth."""
    deepest = -least - margin
    return stake if deepest <= 0.0 else min(stake, share / deepest)
