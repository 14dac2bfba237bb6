"""GitHub's limits for SARIF files, and how to reduce a large report to them.

Uploads to code scanning have these limits, as documented in 2026: 10 MB after compression by gzip; 25,000 results
in a run, of which the 5,000 most severe are shown; and 10,000 locations of thread flows in a result, of which 1,000
are shown.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final

MOST_RESULTS: Final = 5_000
MOST_STEPS: Final = 1_000
MOST_BYTES: Final = 10_000_000  # maximum size of a compressed report (bytes)


@dataclass(frozen=True)
class Cut:
    """How much of a report is written: the number of results, and the longest list of steps shown in full."""

    results: int
    steps: int


EVERYTHING: Final = Cut(sys.maxsize, sys.maxsize)


def cuts(results: int) -> Iterator[Cut]:
    """Yield ever smaller reports: first reduce lists of steps to their shortest chains, then omit results."""
    count = min(results, MOST_RESULTS)
    yield Cut(count, MOST_STEPS)
    while True:
        yield Cut(count, 0)
        if not count:
            return
        count //= 2


def taken(text: str) -> bool:
    """Return whether GitHub accepts the size of a report in ASCII."""
    if len(text) <= MOST_BYTES:
        return True
    import gzip  # imported only for large reports, which are rare

    return len(gzip.compress(text.encode("ascii"), 6)) <= MOST_BYTES
