"""Enumerate all groups of a permutation test, for small samples."""

from __future__ import annotations

from functools import lru_cache
from itertools import chain, combinations
from math import comb

import numpy as np

from pytest_tarl.learning.tables import Ints


def enumerable(rows: int, chosen: int, shuffles: int) -> bool:
    """Return whether, besides the observed group, there are at most `shuffles` groups of `chosen` rows."""
    return comb(rows, chosen) - 1 <= shuffles


@lru_cache(maxsize=8)
def other_groups(rows: int, chosen: int) -> Ints:
    """Return the rows of every group except the observed one, shape (groups - 1, chosen).

    With the observed group added, a permutation test over these groups is exact, and its smallest p-value is 1 /
    groups.
    """
    members = chain.from_iterable(combinations(range(rows), chosen))
    groups = np.fromiter(members, np.int64, comb(rows, chosen) * chosen).reshape(-1, chosen)[1:]
    groups.flags.writeable = False  # read-only, because all callers share the array
    return groups
