"""Number the sites (statements to record) of an analysis, with one taint list per pair of source and sink topic."""

from __future__ import annotations

import difflib
import heapq
from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise, product
from typing import TYPE_CHECKING, Protocol

from pytest_tarl.model import SitePlace, TaintList

if TYPE_CHECKING:
    from tarl_lint.model import Flow, SiteId, Step

Position = tuple[int, int]  # line and column of a statement's first character, both from 1
Positions = Mapping[Position, int]  # position → global site number


class HasFlows(Protocol):
    """The part of `tarl_lint.api.Analysis` that `plan` uses."""

    @property
    def flows(self) -> Sequence[Flow]:
        """Return all flows."""
        ...


@dataclass(frozen=True, slots=True)
class Plan:
    """The sites to record.

    A global site number is an index into `places`; `members[i]` has the numbers of the sites in `lists[i]`. `positions`
    has the sites of each path, named as in the analysis; columns count characters. `forwarded` has the indices of the
    lists whose callback is ROS's own publish method, so that no statement runs when a message passes through.
    """

    lists: tuple[TaintList, ...]
    places: tuple[SitePlace, ...]
    members: tuple[tuple[int, ...], ...]
    positions: Mapping[str, Positions]
    forwarded: frozenset[int] = frozenset()

    @property
    def publishes(self) -> frozenset[int]:
        """Return the sites without a value; only the fact that they are reached is recorded."""
        return frozenset(number for number, place in enumerate(self.places) if place.role == "publish")


def plan(analysis: HasFlows) -> Plan:
    """Number the data and control steps of all flows; context steps are never instrumented."""
    grouped: dict[tuple[str, str], list[Flow]] = defaultdict(list)
    for flow in analysis.flows:
        for pair in product(_topics(flow.source), _topics(flow.sink)):
            grouped[pair].append(flow)
    ordered = {pair: _merged([_scored(flow) for flow in flows]) for pair, flows in sorted(grouped.items())}
    number = _numbering(step for steps in ordered.values() for step in steps)
    places = tuple(_place(step) for step in number.values())
    index = {site: position for position, site in enumerate(number)}
    members = tuple(tuple(index[step.site] for step in steps) for steps in ordered.values())
    lists = tuple(
        TaintList(source, sink, tuple(places[n] for n in sites))
        for (source, sink), sites in zip(ordered, members, strict=True)
    )
    forwarded = frozenset(
        index for index, pair in enumerate(ordered) if all(map(_is_forwarded, grouped[pair]))
    )
    return Plan(lists, places, members, _positions(number.values()), forwarded)


def _is_forwarded(flow: Flow) -> bool:
    """Return whether a subscription publishes directly, as in `Subscriber(…, pub.publish)`."""
    return flow.sink.span in (flow.source.span, *flow.source.registered)


def relocate(positions: Positions, before: str, after: str) -> dict[Position, int]:
    """Find the positions of the sites of `before` in an edited text.

    A block of changed lines keeps its sites if it still has the same number of lines. Sites on removed lines are
    dropped.
    """
    lines: dict[int, int] = {}
    matcher = difflib.SequenceMatcher(None, before.split("\n"), after.split("\n"), autojunk=False)
    for tag, first, last, start, end in matcher.get_opcodes():
        if tag == "equal" or (tag == "replace" and last - first == end - start):
            lines.update(zip(range(first + 1, last + 1), range(start + 1, end + 1), strict=True))
    return {(lines[line], column): n for (line, column), n in positions.items() if line in lines}


def _topics(end: object) -> tuple[str, ...]:
    topics: tuple[str, ...] = getattr(end, "topics", ())
    if topics:
        return topics
    span = getattr(end, "span", None)
    return (f"({getattr(end, 'api', '')} at {span.path}:{span.line})" if span else "(unknown)",)


def _scored(flow: Flow) -> list[Step]:
    return [step for step in flow.steps if step.dependence != "context"]


def _merged(chains: Sequence[Sequence[Step]]) -> list[Step]:
    """Merge taint lists, keeping the order of each as far as they agree, and sorting by position otherwise."""
    best: dict[SiteId, Step] = {}
    followers: dict[SiteId, set[SiteId]] = defaultdict(set)
    waiting: dict[SiteId, int] = defaultdict(int)
    for chain in chains:
        for step in chain:
            known = best.setdefault(step.site, step)
            if known.dependence == "control" and step.dependence == "data":
                best[step.site] = step
        for earlier, later in pairwise(chain):
            if later.site not in followers[earlier.site]:
                followers[earlier.site].add(later.site)
                waiting[later.site] += 1
    return list(_topological(best, followers, waiting))


def _topological(
    steps: Mapping[SiteId, Step], followers: Mapping[SiteId, set[SiteId]], waiting: dict[SiteId, int]
) -> Iterator[Step]:
    """Yield steps in topological order; enter each cycle at its first line."""
    left = dict(sorted(steps.items(), key=lambda item: item[1].span))
    ready = [(step.span, site) for site, step in left.items() if not waiting[site]]
    heapq.heapify(ready)
    while left:
        site = heapq.heappop(ready)[1] if ready else next(iter(left))
        if site not in left:
            continue
        yield left.pop(site)
        for later in followers.get(site, ()):
            waiting[later] -= 1
            if not waiting[later] and later in left:
                heapq.heappush(ready, (left[later].span, later))


def _numbering(steps: Iterable[Step]) -> dict[SiteId, Step]:
    """Return one step per site, ordered by file and position; a data step wins over a control step."""
    distinct: dict[SiteId, Step] = {}
    for step in steps:
        if step.site not in distinct or step.dependence == "data":
            distinct[step.site] = step
    return dict(sorted(distinct.items(), key=lambda item: item[1].span))


def _place(step: Step) -> SitePlace:
    span, site = step.span, step.site
    return SitePlace(str(site), span.path, span.line, step.code, step.dependence, step.role, site.qualname)


def _positions(steps: Iterable[Step]) -> dict[str, dict[Position, int]]:
    found: dict[str, dict[Position, int]] = defaultdict(dict)
    for number, step in enumerate(steps):
        found[step.span.path].setdefault((step.span.line, step.span.column), number)
    return dict(found)
