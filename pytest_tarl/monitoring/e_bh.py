"""Find the changed cells by the e-BH procedure, with one e-value per cell.

An e-value measures evidence against a hypothesis: it is at most 1 on average if the hypothesis is true. A cell's ranks
are independent of earlier ranks in that cell, but not of those in other cells. The running maximum of each cell's
evidence is therefore adjusted first, so that it remains an e-value despite this dependence (Choe & Ramdas 2024). Then
e-BH (Wang & Ramdas 2022) keeps the expected share of wrong cells among the reported ones at or below α, at any time and
under any dependence.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from pytest_tarl.learning.tables import Floats


def adjusted(log_peak: NDArray[np.float64]) -> Floats:
    """Return log2 of the adjusted running maximum, (x - 1 - ln x) / ln² x, from log2 of x ≥ 1.

    The result has the shape of the input. The function is the mean of the adjusters k·x^(1-k) over k in (0, 1). An
    adjuster is a function F with ∫ F(x)/x² dx ≤ 1 over [1, ∞).
    """
    natural = np.asarray(log_peak) * np.log(2.0)
    small = np.minimum(natural, 30.0)
    with np.errstate(invalid="ignore", divide="ignore"):
        exact = np.log2((np.expm1(small) - small) / small**2)
        large = log_peak - 2.0 * np.log2(natural)
    value = np.where(natural > 30.0, large, exact)
    return np.where(natural < 1e-3, -1.0, value)  # the limit at 0: F(1) = 1/2, whose log2 is -1


def chosen(log_evidence: NDArray[np.float64], alpha: float) -> NDArray[np.bool_]:
    """Return which hypotheses e-BH rejects at the false discovery rate α, shape (cells,).

    `log_evidence` is log2 of the e-values, in the same shape.
    """
    count = len(log_evidence)
    if not count:
        return np.zeros(0, bool)
    order = np.argsort(-log_evidence, kind="stable")
    needed = np.log2(count / (alpha * np.arange(1, count + 1)))
    passing = np.flatnonzero(log_evidence[order] >= needed)
    picked = np.zeros(count, bool)
    if passing.size:
        picked[order[: passing[-1] + 1]] = True
    return picked
