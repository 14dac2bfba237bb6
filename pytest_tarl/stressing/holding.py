"""Show on fresh seeds how far the guarantee holds: the end of a boundary's interval that is nearer to nominal.

A search sees few episodes at a drift, and rare failures hide in them: a drift that fails 1 in 20 passes 8 episodes two
times in three. So some values at which a search saw no failure lie too far from nominal. Here, two values are chosen
from the episodes of the search, and tested on seeds that it did not use; the risk is divided among all tests. If the
margin does not rise with the drift, the boundary lies beyond each value at which the guarantee holds.
"""

from __future__ import annotations

from bisect import bisect_left

from pytest_tarl.learning.bounds import episodes_for_quantile, rate
from pytest_tarl.stressing.candidates import Model
from pytest_tarl.stressing.evaluating import Evaluator
from pytest_tarl.stressing.findings import NEAR_RISK, Curve
from pytest_tarl.stressing.guarantee import LEAST, enough_pass, little_lost
from pytest_tarl.stressing.rays import Ray

SHARES = (0.85, 0.15)  # of the risk: of the first and second value, and of the tests at each, see `holds`
SECOND = 0.5  # the second value, as a share of the first
BATCH = 8  # episodes after which a test that can no longer succeed ends
PAIRED = (16, 32)  # numbers of episodes that bound the loss, unless the marker declares total_range


def hold(curve: Curve, evaluator: Evaluator) -> None:
    """Set `curve.held` to a value at which fresh seeds show that the guarantee holds, as far from nominal as possible.

    This is wrong with a probability of at most NEAR_RISK. Values for which the budget does not suffice are left out.
    """
    values, paired = _values(curve, evaluator)
    for t, share in zip(values, SHARES, strict=True):
        if t > 0.0 and holds(curve.ray, t, evaluator, share * NEAR_RISK, paired):
            curve.held = t
            return


def holds(ray: Ray, t: float, evaluator: Evaluator, risk: float, paired: int) -> bool:
    """Return whether fresh seeds show at `risk` that the guarantee holds at a value of a ray.

    The first test allows no failed episode; if there is one, a second and longer test allows it. `paired` episodes
    bound the loss, or all if the marker declares total_range.
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
    """Return the least number of episodes that show a success rate of `share` although `failed` of them failed."""
    # of failed + 1 groups of episodes, one would have no failure
    most = (failed + 1) * episodes_for_quantile(1.0 - share, 1.0 - risk / (failed + 1))
    sizes = range(LEAST, max(most, LEAST) + 1)
    return sizes[bisect_left(sizes, True, key=lambda n: rate(n - failed, n, 1.0 - risk).low >= share)]


def _values(curve: Curve, evaluator: Evaluator) -> tuple[tuple[float, float], int]:
    """Return the values to test and how many episodes bound the loss, chosen from the search's episodes only."""
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
