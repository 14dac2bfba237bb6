"""Compare the flows that tarl-lint reports with those of workspaces that were written and judged without it.

    python benchmarks/flows_written.py [benchmarks/flows_written_2/judge]... [--show]

Each workspace is one text: its files follow each other, each after a line `--- path`. The JSON beside it was written
before the linter was run. For each publish call, it names its sources: the subscriptions, services and transform
look-ups that influence the call. Each source has a kind. `data` means that its data is published, `control` that a
decision depends on it, and `event` that only the arrival of a message matters. `also` lists other kinds that count as
right. `weak` marks a source that is not counted, and `why` gives the reason for the judgement. A line that subscribes
to several topics has one source for each, `path:line topic`. From `flows_written_2` on, sources of kind `event` are not
listed, so a report of such a source counts as surplus.

The linter runs with `tf2 = true`. The author of the workspaces also lists the service responses and action results that
a node requests. The linter does not report these as sources. They are counted separately, as events are.
"""

from __future__ import annotations

import argparse
import json
import re
import tempfile
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence, Set
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Final

from written_texts import Texts

from tarl_lint.model import Flow, Source
from tarl_lint.run.runner import run
from tarl_lint.settings.config import Config, Options

FOLDER: Final = Path(__file__).with_suffix("")
KINDS: Final = {"explicit": "data", "implicit": "control"}
ANSWERS: Final = ("service.", "action.")  # `Sink.api` begins so for responses; these were not judged
_ASKS: Final = re.compile(r"\b(create_client|ServiceProxy|\w*ActionClient)\(")
Pairs = dict[str, dict[str, str]]  # publish call → source → kind


@dataclass
class Counts:
    """The counts of a folder, and a remark on each difference."""

    of: Counter[str] = field(default_factory=Counter)
    remarks: list[str] = field(default_factory=list)

    def compare(
        self, call: str, judged: Sequence[Mapping[str, Any]], found: Mapping[str, str], texts: Texts
    ) -> None:
        """Compare the sources of one publish call with the judgement."""
        right = True
        for one in judged:
            if one.get("weak"):
                continue
            name = "asked for" if _ASKS.search(texts.line(one["at"].partition(" ")[0])) else one["kind"]
            kind = found.get(one["at"])
            self.of[name] += 1
            if kind in (one["kind"], *one.get("also", [])):
                self.of[f"{name}, found"] += 1
            elif name in KINDS.values():
                right = False
                self.remarks.append(f"{call}: {name} from {one['at']} is {kind or 'missed'}")
        surplus = sorted(found.keys() - {one["at"] for one in judged})
        self.of["surplus"] += len(surplus)
        self.remarks += [f"{call}: surplus {found[one]} from {one}" for one in surplus]
        self.of["calls"] += 1
        self.of["calls, right"] += right and not surplus


def reported(texts: Texts, known: Mapping[str, str], judged: Pairs) -> Pairs:
    """Return the reported pairs; each source is at its judged place, or else at its reported place."""
    pairs: Pairs = {}
    with tempfile.TemporaryDirectory() as place:
        root = Path(place).resolve()
        texts.unpack(root)
        for finding in run(Options((root,), jobs=1, cache=False), Config(root=root, tf2=True)).findings:
            flow = finding.flow
            if flow is not None and not flow.sink.api.startswith(ANSWERS):
                call, kind = _place(root, flow.sink.span.path, flow.sink.span.line), KINDS[flow.kind]
                kinds = pairs.setdefault(call, {})
                for source in _sources(root, flow, known, judged.get(call, {})):
                    kinds[source] = min(kind, kinds.get(source, kind), key=["data", "control"].index)
    return pairs


def _sources(root: Path, flow: Flow, known: Mapping[str, str], judged: Mapping[str, str]) -> Sequence[str]:
    """Return the judged sources to which a report refers, or the reported place if no judged source matches.

    If several topics share a line, the report refers to all topics that it names. If it names no topic, it refers to
    one of those on the line.
    """
    places = [_place(root, path, line) for path, line in _spots(flow.source)]
    topics = {topic.lstrip("~/") for topic in flow.source.topics}
    lines = ([one for one in known if one.partition(" ")[0] == place] for place in places)
    if there := next(filter(None, lines), []):
        kind = KINDS[flow.kind]
        best = min(there, key=lambda one: (judged.get(one) != kind, one not in judged))
        return [one for one in there if known[one].lstrip("~/") in topics] or [best]
    return list(_near(places, known, topics))[:1] or list(_elsewhere(known, topics)) or places[:1]


def _spots(source: Source) -> Iterator[tuple[str, int]]:
    for span in (source.span, *source.registered, *source.via):
        yield span.path, span.line


def _near(places: Sequence[str], known: Mapping[str, str], topics: Set[str]) -> Iterator[str]:
    """Yield the judged sources with the same topic at most three lines away: the author may have named another line."""
    for place in places:
        path, _, number = place.rpartition(":")
        for one, topic in known.items():
            other, _, line = one.partition(" ")[0].rpartition(":")
            if other == path and abs(int(line) - int(number)) <= 3 and topic.lstrip("~/") in topics:
                yield one


def _elsewhere(known: Mapping[str, str], topics: Set[str]) -> Iterator[str]:
    """Yield the judged source of each topic that has only one: the judged line may subscribe through a wrapper."""
    for name in sorted(topics):
        same = [one for one, topic in known.items() if topic.lstrip("~/") == name]
        if len(same) == 1:
            yield from same


def _place(root: Path, path: str, line: int) -> str:
    return f"{Path(path).resolve().relative_to(root).as_posix()}:{line}"


def main(arguments: Sequence[str] | None = None) -> None:
    """Print the counts of each folder."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("folders", type=Path, nargs="*")
    parser.add_argument("--show", action="store_true", help="print each difference")
    options = parser.parse_args(arguments)
    for folder in options.folders or sorted(one for one in FOLDER.iterdir() if one.is_dir()):
        counts = Counts()
        for file in sorted(folder.glob("*.json")):
            truth, texts = json.loads(file.read_text("utf-8")), Texts.read(file.with_suffix(".txt"))
            calls = truth["calls"].items()
            kinds = {call: {one["at"]: one["kind"] for one in judged} for call, judged in calls}
            pairs = reported(texts, truth["sources"], kinds)
            for call, judged in calls:
                counts.compare(call, judged, pairs.get(call, {}), texts)
        print(folder.name)
        for name in ("calls, right", "data, found", "control, found", "event, found", "asked for, found"):
            print(f"{name:>20}: {counts.of[name]} of {counts.of[name.partition(',')[0]]}")
        print(f"{'surplus':>20}: {counts.of['surplus']}")
        for remark in counts.remarks if options.show else ():
            print(f"    {remark}")


if __name__ == "__main__":
    main()
