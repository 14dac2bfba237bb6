"""Sobol indices: how much of the margin's variance over the declared space comes from each direction.

SALib creates the sample and the estimates (Saltelli et al. 2010, doi:10.1016/j.cpc.2009.09.018). It is imported only
when needed, because it imports pandas and matplotlib.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from pytest_tarl.extras import missing_sobol
from pytest_tarl.seeds import episode_seed
from pytest_tarl.spaces import Choice, Point, Space, Span
from pytest_tarl.stressing.evaluating import Evaluator
from pytest_tarl.stressing.findings import CONFIDENCE, Share, Sobol
from pytest_tarl.stressing.guarantee import LOWEST, margin_of_one

ROWS = (
    256,
    128,
    64,
    32,
)  # possible sizes of the base sample; Sobol sequences are balanced at powers of two
POOL = "sobol"  # name of the pool of seeds for this analysis
RESAMPLES = 200  # number of bootstrap resamples for the intervals


def sobol(evaluator: Evaluator) -> Sobol | None:
    """Compute the indices with the episodes that the search left over.

    Return None if too few episodes are left or SALib is not installed. All points in a row of the sample share a seed
    and are paired with the nominal episode of that seed. Raise BudgetSpentError if the time limit is reached.
    """
    size = len(evaluator.space.extents)
    rows = affordable(size, evaluator.left)
    if not rows or missing_sobol("") is not None:
        return None
    before = evaluator.spent
    margins = _margins(evaluator, rows)
    names = [*evaluator.space.extents]
    if float(np.ptp(margins)) == 0.0:  # all margins are equal, so there is no variance to explain
        shares = tuple(Share(name, 0.0, 0.0, 0.0, 0.0) for name in names)
        return Sobol(evaluator.spent - before, shares, hopeless=float(margins[0]) == LOWEST)
    from SALib.analyze import sobol as estimates

    found = estimates.analyze(
        _problem(evaluator.space),
        margins,
        calc_second_order=False,
        num_resamples=RESAMPLES,
        conf_level=CONFIDENCE,
        seed=_seed(evaluator) or 1,  # SALib treats 0 as "no seed"
    )
    columns = [found[key].tolist() for key in ("S1", "S1_conf", "ST", "ST_conf")]
    shares = tuple(Share(name, *map(_short, four)) for name, *four in zip(names, *columns, strict=True))
    return Sobol(evaluator.spent - before, shares)


def affordable(size: int, left: int) -> int:
    """Return how many sample rows `left` episodes allow for `size` directions, or 0 if there are too few."""
    return next((rows for rows in ROWS if rows * (size + 3) <= left), 0) if size > 1 else 0


def _margins(evaluator: Evaluator, rows: int) -> Any:
    """Return the margin of one episode per point of the sample, shape (rows × (directions + 2),)."""
    from SALib.sample import sobol as sampling

    space, given = evaluator.space, evaluator.guarantee
    numbers = sampling.sample(_problem(space), rows, calc_second_order=False, seed=_seed(evaluator))
    block = len(space.extents) + 2
    usual = evaluator.singly(POOL, [space.nominal] * rows, range(rows))
    places = [number // block for number in range(rows * block)]
    drawn = evaluator.singly(POOL, [_point(space, one) for one in numbers], places)
    return np.array(
        [
            max(margin_of_one(given, one, usual[place]), LOWEST)
            for one, place in zip(drawn, places, strict=True)
        ]
    )


def _point(space: Space, numbers: Any) -> Point:
    """Return the point for numbers from 0 to 1, one for each direction."""
    return {
        name: _number(extent, float(number))
        for (name, extent), number in zip(space.extents.items(), numbers, strict=True)
    }


def _number(extent: Span | Choice, share: float) -> float:
    if isinstance(extent, Choice):
        return float(min(int(share * len(extent.options)), len(extent.options) - 1))
    return min(extent.low + share * (extent.high - extent.low), extent.high)


def _problem(space: Space) -> dict[str, Any]:
    names = [*space.extents]
    return {"num_vars": len(names), "names": names, "bounds": [[0.0, 1.0]] * len(names)}


def _seed(evaluator: Evaluator) -> int:
    return episode_seed(evaluator.seed, f"stress {evaluator.drift} {POOL} sample", 0) % 2**31


def _short(number: float) -> float:
    return round(number, 6)
