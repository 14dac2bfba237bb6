"""Convert flat event buffers to numpy columns."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pytest_tarl.instrumentation.magnitude import LIMIT
from pytest_tarl.instrumentation.trace import Floats, Ints

Starts = NDArray[np.int64]
Pairs = tuple[Ints, Floats, Starts]


def paired(entries: list[Any]) -> Pairs:
    """Split `[site, value, site, value, …]` into site, value and start index, each of shape (events,).

    If a signal handler raises (a timeout, Ctrl-C), a site may lack its value. Such incomplete events are dropped.
    """
    if len(entries) % 2 == 0 and set(map(type, entries[1::2])) <= {float}:
        even: Starts = np.arange(0, len(entries), 2)
        return np.array(entries[0::2], np.int32), np.array(entries[1::2], np.float64), even
    starts: Starts = np.array(_whole(entries), np.int64)
    sites = np.array([entries[i] for i in starts], np.int32)
    return sites, np.array([entries[i + 1] for i in starts], np.float64), starts


def joined(parts: Sequence[Pairs]) -> Pairs:
    """Concatenate the pieces in order; each result has shape (events,)."""
    if len(parts) == 1:
        return parts[0]
    site, flow, starts = zip(*parts, strict=True)
    return np.concatenate(site), np.concatenate(flow), np.concatenate(starts)


def sizes(flow: Floats) -> Floats:
    """Return the flow value (see `magnitude`) of each float in `flow`; both have shape (events,)."""
    return np.abs(limited(flow))


def limited(values: Floats) -> Floats:
    """Return the signed values, limited to ±LIMIT, with infinity and NaN as 0; both have shape (events,)."""
    return np.where(np.isfinite(values), np.clip(values, -LIMIT, LIMIT), 0.0)


def _whole(entries: list[Any]) -> list[int]:
    """Return the start of every complete event: a site (int) followed by a value (float)."""
    pairs = enumerate(pairwise(entries))
    return [start for start, (site, value) in pairs if type(site) is int and type(value) is float]
