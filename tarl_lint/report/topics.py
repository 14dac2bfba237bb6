"""The diagram of a run as a graph of topics, publishing functions and flows."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import count
from typing import Final, NamedTuple

from tarl_lint.fingerprints import UNKNOWN
from tarl_lint.model import Finding, Flow, Kind, Sink, Source
from tarl_lint.run.runner import Result

_NAMED: Final = 3  # maximum number of functions named in one box


@dataclass(frozen=True, order=True)
class Topic:
    """A topic, identified by its name without the leading slash, or by its place of use if the name is unknown."""

    key: str
    label: str


@dataclass(frozen=True)
class Part:
    """Publish calls of one file that the same topics reach in the same way (`kind`).

    A box therefore represents many flows, and every path through the box is a flow.
    """

    path: str
    label: str
    inputs: tuple[tuple[Topic, Kind], ...]
    outputs: tuple[Topic, ...]
    new: bool


@dataclass(frozen=True)
class Picture:
    """Parts by file title, and all topics, both sorted."""

    files: tuple[tuple[str, tuple[Part, ...]], ...]
    topics: tuple[Topic, ...]

    def numbers(self) -> dict[str, str]:
        """Return topic key → short name."""
        return {topic.key: f"t{number}" for number, topic in enumerate(self.topics)}

    def boxes(self) -> Iterator[tuple[str, tuple[tuple[str, Part], ...]]]:
        """Yield each file's title and its parts, each part with a unique short name."""
        numbers = count()
        for title, parts in self.files:
            yield title, tuple((f"p{next(numbers)}", part) for part in parts)


def picture(result: Result) -> Picture:
    """Return the diagram of all flows of a run, including accepted flows; with a baseline, new flows are marked."""
    flows = [(f, f.flow) for f in result.findings if f.flow]
    marked = result.baseline is not None
    parts = sorted(_parts(flows, _names(flows), marked=marked), key=lambda p: (p.path, p.label, p.inputs))
    paths = sorted({part.path for part in parts})
    titles = short_names(paths)
    files = tuple((titles[path], tuple(p for p in parts if p.path == path)) for path in paths)
    topics = {t for p in parts for t in (*(i for i, _ in p.inputs), *p.outputs)}
    return Picture(files, tuple(sorted(topics)))


def _names(flows: Sequence[tuple[Finding, Flow]]) -> Mapping[str, Topic]:
    """Return the topics by key.

    Different spellings of a topic get one label, which has a slash if any spelling has a slash.
    """
    every = {topic for _, flow in flows for end in (flow.source, flow.sink) for topic in _topics(end)}
    return {topic.key: topic for topic in sorted(every, reverse=True)}


def _parts(
    flows: Sequence[tuple[Finding, Flow]], names: Mapping[str, Topic], *, marked: bool
) -> Iterator[Part]:
    """Merge the publish calls of a class or file that the same sources reach."""
    calls: dict[Sink, list[tuple[Finding, Flow]]] = {}
    for finding, flow in flows:
        calls.setdefault(flow.sink, []).append((finding, flow))
    alike: dict[_Likeness, list[Sink]] = {}
    for sink, pairs in calls.items():
        inputs = {(names[topic.key], flow.kind) for _, flow in pairs for topic in _topics(flow.source)}
        new = marked and any(finding.status == "new" for finding, _ in pairs)
        owner = sink.qualname.rpartition(".")[0]
        alike.setdefault(_Likeness(sink.span.path, owner, frozenset(inputs), new), []).append(sink)
    for key, sinks in alike.items():
        outputs = sorted({names[topic.key] for sink in sinks for topic in _topics(sink)})
        yield Part(key.path, _label(sinks), tuple(sorted(key.inputs)), tuple(outputs), key.new)


class _Likeness(NamedTuple):
    """The properties that all publish calls in one box have in common."""

    path: str
    owner: str
    inputs: frozenset[tuple[Topic, Kind]]
    new: bool


def _label(sinks: Sequence[Sink]) -> str:
    """Return the names of the publishing functions."""
    names = sorted({sink.qualname or "<module>" for sink in sinks})
    more = [f"and {len(names) - _NAMED} more"] if len(names) > _NAMED else []
    return "\n".join([*names[:_NAMED], *more])


def _topics(end: Source | Sink) -> Iterator[Topic]:
    for name in end.topics:
        yield Topic(name.lstrip("/") or name, name)
    if not end.topics:
        label = f"{UNKNOWN} ({end.type})" if end.type else UNKNOWN
        yield Topic(f"{UNKNOWN} {end.id}", label)


def short_names(paths: Sequence[str]) -> dict[str, str]:
    """Return path → shortest suffix that is unique among the paths."""
    names = {path: path.rpartition("/")[2] for path in paths}
    while True:
        counts = Counter(names.values())
        unclear = [path for path, name in names.items() if counts[name] > 1 and name != path]
        if not unclear:
            return names
        for path in unclear:
            depth = names[path].count("/") + 2
            names[path] = "/".join(path.split("/")[-depth:])
