"""Show on fresh seeds how far the guarantee holds: the near end of the interval around a boundary.

A search runs only a few episodes at each drift and can miss rare failures: if 1 in 20 episodes fails, 8 episodes all
pass two times in three. The last value without a failure is therefore often beyond the boundary. This module chooses
two values from the search's episodes and tests them on fresh seeds. All tests share the risk. If the margin never rises
with the drift, the boundary lies beyond each value that holds.
"""

from __future__ import annotations

from bisect import bisect_left

from pytest_tarl.learning.bounds import episodes_for_quantile, rate
from pytest_tarl.stressing.evaluating import Evaluator
from pytest_tarl.stressing.findings import NEAR_RISK, Curve
from pytest_tarl.stressing.fresh_values import Model
from pytest_tarl.stressing.guarantee import LEAST, enough_pass, little_lost
from pytest_tarl.stressing.rays import Ray

# shares of the risk for the first and second value, and for the two tests of each value
SHARES = (0.85, 0.15)
SECOND = 0.5  # the second value to test, as a share of the first
BATCH = 8  # number of episodes after which a test checks whether it can still succeed
PAIRED = (16, 32)  # numbers of episodes for the bound on the loss, if the marker declares no total_range


def hold(curve: Curve, evaluator: Evaluator) -> None:
    """Set `curve.held` to the farthest chosen value that holds on fresh seeds.

    The value is wrong with at most the probability NEAR_RISK. Values whose test exceeds the budget are skipped. Raise
    BudgetSpentError if the time limit ends a test.
    """
    values, paired = _values(curve, evaluator)
    for t, share in zip(values, SHARES, strict=True):
        if t > 0.0 and holds(curve.ray, t, evaluator, share * NEAR_RISK, paired):
            curve.held = t
            return


def holds(ray: Ray, t: float, evaluator: Evaluator, risk: float, paired: int) -> bool:
    """Return whether fresh seeds show that the guarantee holds at position t, with error probability `risk`.

    The first test allows no failed episode. If one episode fails, a longer second test follows, which allows one
    failure. The bound on the loss uses `paired` episodes, or all of them if the marker declares total_range.
    """
    given, point, nominal = evaluator.guarantee, ray.point(t), evaluator.space.nominal
    for allowed, share in enumerate(SHARES):
        episodes = least(given.rate, allowed, share * risk)
        paired = episodes if given.declared else min(episodes, paired)
        if not evaluator.affords(point, episodes, paired):
            return False
        for size in sorted({*range(BATCH, episodes, BATCH), paired, episodes}):
            outcomes = evaluator.fresh(point, size)
            if sum(not one.passed for one in outcomes) >= len(SHARES):
                return False
            if size == paired and not little_lost(
                given, outcomes, evaluator.fresh(nominal, size), share * risk
            ):
                return False
        if enough_pass(given, outcomes, share * risk):
            return True
    return False


def least(share: float, failed: int, risk: float) -> int:
    """Return how many episodes are needed to show a success rate of `share` if `failed` of them fail."""
    # upper limit of the search: among `failed` + 1 groups of episodes, at least one has no failure
    most = (failed + 1) * episodes_for_quantile(1.0 - share, 1.0 - risk / (failed + 1))
    sizes = range(LEAST, max(most, LEAST) + 1)
    return sizes[bisect_left(sizes, True, key=lambda n: rate(n - failed, n, 1.0 - risk).low >= share)]


def _values(curve: Curve, evaluator: Evaluator) -> tuple[tuple[float, float], int]:
    """Return the two values of t to test, and the number of episodes for the bound on the loss.

    The values are chosen only by the search's episodes, so the tests on fresh seeds stay independent. A value of 0 is
    not tested.
    """
    if not curve.ray.continuous:
        return (1.0, 0.0), PAIRED[0]
    given = evaluator.guarantee
    first = SHARES[0] ** 2 * NEAR_RISK
    if curve.bracket is None:
        return (1.0, SECOND), PAIRED[-1]
    near, model = curve.bracket[0], Model(curve.evidence, given.tolerance)
    few, many = (min(near, model.holding(least(given.rate, 0, first), one)) for one in PAIRED)
    paired = PAIRED[0] if few >= many else PAIRED[-1]
    return ((many, SECOND * many) if many > 0.0 else (SECOND * near, 0.0)), paired
