"""Is a mean above a limit? Bets on every episode against the claim that it is not (Waudby-Smith & Ramdas 2023).

Who bets a fixed share of what he has on a fair game multiplies it by 1/risk with probability `risk` at most, whatever
the shape of the totals is, and however often he looks (Ville). Two bets share the money: a bold one, which wins soon
where no episode is bad, and one that survives a few bad ones.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import exp, inf, log, log1p
from statistics import fmean, variance

from pytest_tarl.learning.bounds import mean_of

BOLD, CAREFUL = 0.95, 0.5  # shares that may be lost in the worst episode there is
DOUBT = 1.5  # by which a variance of few episodes is taken for larger than it looks
CERTAIN = (
    0.005  # risk, about, at which a mean is taken to be below the limit: this ends tests, it accepts nothing
)


@dataclass(frozen=True, slots=True)
class Bet:
    """Bets that differences are above `-margin` on average; those below `least` count as that.

    `stakes` are per unit of reward.
    """

    margin: float
    least: float
    stakes: tuple[float, ...]

    def wealth(self, differences: Sequence[float]) -> float:
        """Return the logarithm of what one unit has become; -inf where all was lost."""
        each = [_grown(stake, differences, self.margin, self.least) for stake in self.stakes]
        most = max(each)
        return most if most == -inf else most + log(fmean(exp(one - most) for one in each))

    def hopeless(self, differences: Sequence[float], left: int, risk: float) -> bool:
        """Tell whether `left` more episodes, as good as those seen may truly be, would not win the bet."""
        counted = [max(one, self.least) for one in differences]
        best = mean_of(counted, 1.0 - CERTAIN).high
        if best < -self.margin:
            return True
        growing = [log1p(stake * (max(best, 0.0) + self.margin)) for stake in self.stakes]
        return self.wealth(differences) + left * max(growing) < -log(risk)


def bet(margin: float, least: float, known: Sequence[float]) -> Bet:
    """Return the bets that grow fast if differences are as in `known`, episodes of which none is bet on."""
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
    """Return a stake that loses this share of the money, at most, in the worst episode."""
    deepest = -least - margin
    return stake if deepest <= 0.0 else min(stake, share / deepest)
