"""List the events of a taint list in an episode, in order, each with its reward.

An event is one execution of a site, which is a statement of the taint list.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from pytest_tarl.learning.tables import START, Floats, Ints, sum_by

if TYPE_CHECKING:
    from pytest_tarl.instrumentation.trace import Trace

Steps = NDArray[np.int32]


@dataclass(frozen=True)
class EventSequence:
    """The start and the events of a taint list in one thread; columns have shape (events + 1,).

    `reward` is r for the last event of a step and 0 for others; `scaled` is r·|f|, where f is the flow value.
    """

    state: Ints
    reward: Floats
    scaled: Floats
    flow: Floats


def event_sequences(trace: Trace, members: Sequence[int]) -> tuple[EventSequence, ...]:
    """Return the events of a taint list; its n-th site has the global number `members[n]`, or -1 if unknown.

    There is one sequence per thread (at least one), because events of two threads in the same step have no order.

    A step's reward goes to its last event. If several threads have events in the step, each gets an equal share. The
    reward of a step without events goes to the latest earlier step with events, or to the start of the first sequence.
    The rewards therefore sum to the episode's total. Events before the first cell are dropped.
    """
    index = _places(trace, members)
    known = (index >= 0) & (trace.event_cell >= 0)
    chosen = slice(None) if known.all() else known
    step, site = trace.event_step[chosen], index[chosen]
    flow = np.abs(trace.flow[chosen])
    state = trace.event_cell[chosen] * np.int64(len(members))
    state += site + 1
    scaled = (trace.reward[step] if trace.reward.size else np.zeros(step.shape)) * flow
    if trace.thread is None:
        unclaimed, given = _given(step, None, trace.reward)
        return (_begun(unclaimed, state, given, scaled, flow),)
    thread = trace.thread[chosen]
    unclaimed, given = _given(step, thread, trace.reward)
    threads = np.unique(thread) if thread.size else np.zeros(1, np.int32)
    return tuple(
        _begun(0.0 if place else unclaimed, state[own], given[own], scaled[own], flow[own])
        for place, own in enumerate(thread == one for one in threads)
    )


def _begun(unclaimed: float, state: Ints, given: Floats, scaled: Floats, flow: Floats) -> EventSequence:
    """Add the start before the events; it gets the rewards of all steps before the first event."""
    whole = np.empty(state.size + 1, np.int64)
    whole[0], whole[1:] = START, state
    columns = [np.empty(state.size + 1) for _ in range(3)]
    for column, first, rest in zip(columns, (unclaimed, 0.0, 0.0), (given, scaled, flow), strict=True):
        column[0], column[1:] = first, rest
    return EventSequence(whole, *columns)


def _places(trace: Trace, members: Sequence[int]) -> Steps:
    """Return the index of each event's site in the taint list, or -1 if it is not in the list; shape (events,)."""
    place = np.full(max([*members, int(trace.site.max(initial=-1)), 0]) + 1, -1, dtype=np.int32)
    for n, site in enumerate(members):
        if site >= 0:
            place[site] = n
    return place[trace.site]


def _given(step: Steps, thread: Steps | None, reward: Floats) -> tuple[float, Floats]:
    """Return the rewards of all steps before the first event, and the reward of each event, shape (events,)."""
    given = np.zeros(step.size)
    last = np.ones(step.size, dtype=bool)
    np.not_equal(step[1:], step[:-1], out=last[:-1])
    if thread is not None:
        last[:-1] |= thread[1:] != thread[:-1]
    eventful, sharing = np.unique(step[last], return_counts=True)
    owner = np.searchsorted(eventful, np.arange(reward.size), side="right")
    earned = sum_by(owner, reward, eventful.size + 1)
    given[last] = np.repeat(earned[1:] / sharing, sharing)
    return float(earned[0]), given
