"""What GitHub takes of a SARIF file, and how much of a large report to leave out so that it is taken.

Limits as documented for uploads to code scanning (read in 2026): 10 MB compressed by gzip; 25,000 results a run, of
which the 5,000 gravest are shown; 10,000 locations of thread flows a result, of which 1,000 are shown.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final

MOST_RESULTS: Final = 5_000
MOST_STEPS: Final = 1_000
MOST_BYTES: Final = 10_000_000  # compressed


@dataclass(frozen=True)
class Cut:
    """How much of a report is written: so many results, and lists of steps in full up to a length."""

    results: int
    steps: int


EVERYTHING: Final = Cut(sys.maxsize, sys.maxsize)


def cuts(results: int) -> Iterator[Cut]:
    """Yield ever smaller reports: lists of steps are cut to their shortest chains, then results are left out."""
    count = min(results, MOST_RESULTS)
    yield Cut(count, MOST_STEPS)
    while True:
        yield Cut(count, 0)
        if not count:
            return
        count //= 2


def taken(text: str) -> bool:
    """Tell whether a report of ASCII text is small enough."""
    if len(text) <= MOST_BYTES:
        return True
    import gzip  # reports as large as this are rare

    return len(gzip.compress(text.encode("ascii"), 6)) <= MOST_BYTES
