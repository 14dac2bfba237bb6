"""Measure the accuracy of tarl-lint on unseen code: publish calls drawn at random and judged blind.

    python benchmarks/lint_truth.py draw TREES --seed 41 [--each 60] [--without FILE ...] [--judgements FILE]
    python benchmarks/lint_truth.py compare TREES benchmarks/lint_truth/JUDGED.json [--verbose]

TREES is a directory of checkouts, one per repository. The population is every call `x.publish(…)` in their Python
files, found in the syntax tree, without the linter; the linter only says which of them have a report. `draw` takes
equally many calls with and without a report. It prints them sorted by place, so that the order does not show which is
which. Calls in the files given with `--without` (earlier draws, or texts that contain `file.py:line`) are excluded.

Calls are judged from the source alone, before `compare` runs. A judged call names its sources, each with its kind
(`data` or `control`) and the lines that the path in every correct report must contain:

    {"seed": 41, "calls": {"repo/dir/node.py:30": {"from": [{"at": "12", "kind": "data", "path": ["20-22", "30"]}]}}}

A place is a line of the call's file, or `path:line` in the repository. A call with `"skip": "why"` is not a publish
call of ROS. `"uncalled": true` marks a call in code that nothing in its tree calls; these calls have a separate row.
"""

from __future__ import annotations

import argparse
import ast
import json
import random
import re
import sys
import warnings
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Final

from tarl_lint.model import Flow
from tarl_lint.run.runner import run
from tarl_lint.settings.config import Config, Options

KINDS: Final = {"explicit": "data", "implicit": "control"}
ANSWERS: Final = ("rospy.Service", "rclpy.create_service", "actionlib.", "rclpy.action.")


@dataclass(frozen=True, order=True)
class Place:
    """A line of a file; `path` is relative to the directory of the trees."""

    path: str
    line: int

    def __str__(self) -> str:
        return f"{self.path}:{self.line}"

    @classmethod
    def read(cls, text: str, beside: str = "") -> Place:
        """Return the place for `path:line`, or for a line of the file `beside`.

        A path is relative to the directory of the trees if it begins with the same folder as `beside`; otherwise it is
        relative to that folder.
        """
        path, _, line = text.rpartition(":")
        home = beside.partition("/")[0]
        if path and home and not path.startswith(f"{home}/"):
            path = f"{home}/{path}"
        return cls(path or beside, int(line))


def scripts(trees: Path) -> Iterator[Path]:
    """Yield every Python file in the directory, sorted by name."""
    for path in sorted(trees.rglob("*")):
        if path.suffix == ".py" and path.is_file():
            yield path
        elif not path.suffix and path.is_file():
            with path.open("rb") as file:
                first = file.readline(200)
            if first.startswith(b"#!") and b"python" in first:
                yield path


def publish_calls(trees: Path) -> list[Place]:
    """Return the place of every call `x.publish(…)` in the files that Python 3 can parse."""
    found = set[Place]()
    for path in scripts(trees):
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                tree = ast.parse(path.read_bytes())
        except (SyntaxError, ValueError):
            continue
        for node in ast.walk(tree):
            if isinstance(node, ast.Call) and getattr(node.func, "attr", "") == "publish":
                found.add(Place(path.relative_to(trees).as_posix(), node.lineno))
    return sorted(found)


def reported(trees: Path) -> dict[Place, list[Flow]]:
    """Return the flows that tarl-lint reports in each repository, by place of the publish call."""
    flows = dict[Place, list[Flow]]()
    for tree in sorted(path for path in trees.iterdir() if path.is_dir() and not path.name.startswith(".")):
        for finding in run(Options(paths=(tree,), jobs=1, cache=False), Config(root=tree)).findings:
            flow = finding.flow
            if flow is not None and not flow.sink.api.startswith(ANSWERS):
                flows.setdefault(_place(trees, flow.sink.span.path, flow.sink.span.line), []).append(flow)
    return flows


def _place(trees: Path, path: str, line: int) -> Place:
    return Place(Path(path).resolve().relative_to(trees.resolve()).as_posix(), line)


def drawn(calls: Sequence[Place], loud: set[Place], seed: int, each: int) -> list[Place]:
    """Return `each` calls with a report and `each` without one, sorted by place."""
    chance = random.Random(seed)
    found = list[Place]()
    for group in ([c for c in calls if c in loud], [c for c in calls if c not in loud]):
        found += chance.sample(group, min(each, len(group)))
    return sorted(found)


def seen(file: Path) -> set[tuple[str, int]]:
    """Return each `file.py:line` in a text, as the last two parts of the path, and the line."""
    text = file.read_text(encoding="utf-8")
    return {(_tail(path), int(line)) for path, line in re.findall(r"([\w./+-]+):(\d+)", text)}


def _tail(path: str) -> str:
    return "/".join(path.split("/")[-2:])


@dataclass
class Truth:
    """The counts of a comparison, and a remark on each difference."""

    counts: Counter[str] = field(default_factory=Counter)
    remarks: list[str] = field(default_factory=list)

    def compare(self, call: Place, judged: Mapping[str, Any], flows: Sequence[Flow], trees: Path) -> None:
        """Compare the judgement of a publish call with its reports."""
        if judged.get("skip"):
            self.counts["left out"] += 1
            return
        if judged.get("uncalled"):
            self.counts["in methods that nothing calls"] += 1
            self.counts["in methods that nothing calls, reported"] += bool(flows)
            return
        wanted = {Place.read(one["at"], call.path): one for one in judged["from"]}
        found = {_place(trees, flow.source.span.path, flow.source.span.line): flow for flow in flows}
        before = len(self.remarks)
        for source, flow in sorted(found.items()):
            self.counts["reports"] += 1
            self.counts["reports right"] += self._right(call, source, wanted.get(source), flow, trees)
        for source in sorted(wanted.keys() - found.keys()):
            self.remarks.append(f"{call}: missed {wanted[source]['kind']} from {source}")
            self.counts["flows missed"] += 1
        self.counts["flows judged"] += len(wanted)
        name = "calls with a report" if flows else "silent calls"
        self.counts[name] += 1
        self.counts[f"{name}, right"] += len(self.remarks) == before

    def _right(
        self, call: Place, source: Place, wanted: Mapping[str, Any] | None, flow: Flow, trees: Path
    ) -> bool:
        kind = KINDS[flow.kind]
        if wanted is None:
            self.remarks.append(f"{call}: false {kind} from {source}")
            return False
        if wanted["kind"] != kind:
            self.remarks.append(f"{call}: {kind} from {source}, judged {wanted['kind']}")
            return False
        steps = {
            _place(trees, s.span.path, line)
            for s in flow.steps
            if s.dependence != "context"
            for line in range(s.span.line, s.span.end_line + 1)
        }
        lacking = [p for p in lines(wanted.get("path", ()), call.path) if p not in steps]
        if lacking:
            shown = ", ".join(str(p.line if p.path == call.path else p) for p in lacking)
            self.remarks.append(f"{call}: {kind} from {source} lacks {shown}")
        return not lacking


def lines(texts: Sequence[str], beside: str) -> Iterator[Place]:
    """Yield the places in a judged path: lines or ranges of lines, optionally after a path and a colon."""
    for text in texts:
        path, _, span = text.rpartition(":")
        first, _, last = span.partition("-")
        for line in range(int(first), int(last or first) + 1):
            yield Place.read(f"{path}:{line}" if path else str(line), beside)


def draw(options: argparse.Namespace) -> None:
    """Print the drawn calls."""
    left_out = {place for file in options.without for place in seen(file)}
    calls = [c for c in publish_calls(options.trees) if (_tail(c.path), c.line) not in left_out]
    loud = set(reported(options.trees))
    print(f"{len(calls)} publish calls, {sum(c in loud for c in calls)} with a report", file=sys.stderr)
    for place in drawn(calls, loud, options.seed, options.each):
        print(place)


def compare(options: argparse.Namespace) -> None:
    """Compare the reports with the judgements and print the counts."""
    document = json.loads(options.judgements.read_text(encoding="utf-8"))
    flows, truth = reported(options.trees), Truth()
    for name, judged in sorted(document["calls"].items()):
        call = Place.read(name)
        truth.compare(call, judged, flows.get(call, ()), options.trees)
    for remark in truth.remarks:
        print(remark)
    for name, count in sorted(truth.counts.items()):
        print(f"{name:>40}: {count}")


def main(arguments: Sequence[str] | None = None) -> None:
    """Draw publish calls, or compare reports with judgements."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    commands = parser.add_subparsers(required=True)
    drawing = commands.add_parser("draw", help="print publish calls to judge")
    drawing.add_argument("trees", type=Path, help="directory that contains the repositories")
    drawing.add_argument("--seed", type=int, required=True)
    drawing.add_argument(
        "--each", type=int, default=60, help="number of calls with a report, and of calls without one"
    )
    drawing.add_argument(
        "--without", type=Path, nargs="*", default=[], help="texts that name calls to exclude"
    )
    drawing.set_defaults(run=draw)
    comparing = commands.add_parser("compare", help="compare the reports with judgements")
    comparing.add_argument("trees", type=Path, help="directory that contains the repositories")
    comparing.add_argument("judgements", type=Path, help="JSON file of judged calls")
    comparing.set_defaults(run=compare)
    options = parser.parse_args(arguments)
    if not options.trees.is_dir():
        sys.exit(f"{options.trees} is not a directory: name the one that contains the repositories.")
    options.run(options)


if __name__ == "__main__":
    main()
