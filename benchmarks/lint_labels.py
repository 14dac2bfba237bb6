"""Score tarl-lint on real nodes whose flows are known: `python benchmarks/lint_labels.py CHECKOUT LABELS.json`.

CHECKOUT has the repositories, each in a directory named owner/name, owner__name, owner+name or name. A flow is
identified by the lines of its subscription and publish calls. For each node and in total, the script prints the
following counts:

- flows that are found, found with the wrong kind, missing, or not labelled
- lines of labelled paths that are found
- data steps of found paths that are on labelled or optional lines
- reports at publish calls without a labelled flow

The labels do not cover Python 2 files, or flows from or to services, actions and transforms, so these are not counted.
"""

from __future__ import annotations

import argparse
import json
import sys
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from tarl_lint.api import Analysis, analyse
from tarl_lint.catalog import on_topic
from tarl_lint.model import Flow

Pair = tuple[int, int]  # first lines of the subscription call and the publish call
COUNTS = (
    "explicit", "explicit found", "implicit", "implicit found", "other kind", "missing",
    "surplus explicit", "surplus implicit", "at clean sinks",
)  # fmt: skip
SHARES = (("path lines", "path lines found"), ("data steps", "data steps labelled"))


@dataclass
class Score:
    """Counts, and one line for each difference from the labels."""

    counts: Counter[str] = field(default_factory=Counter)
    remarks: list[str] = field(default_factory=list)

    def add(self, other: Score) -> None:
        """Add the score of another node."""
        self.counts.update(other.counts)
        self.remarks += other.remarks


def score(node: Mapping[str, Any], flows: Sequence[Flow]) -> Score:
    """Compare the flows found in a file with its labels."""
    result = Score()
    wanted = {(f["source_line"], f["sink_line"]): f for f in node["flows"]}
    labelled = [f for f in flows if on_topic(f.source.api) and on_topic(f.sink.api)]
    found = {(f.source.span.line, f.sink.span.line): f for f in labelled}
    for pair, label in wanted.items():
        result.counts[label["kind"]] += 1
        _compare(result, pair, label, found.get(pair))
    for pair, flow in found.items():
        if pair not in wanted:
            result.counts[f"surplus {flow.kind}"] += 1
            clean = pair[1] in node["sinks_without_flow"]
            result.counts["at clean sinks"] += clean
            result.remarks.append(f"surplus {flow.kind} {_shown(pair)}{' at a clean sink' if clean else ''}")
    return result


def _compare(result: Score, pair: Pair, label: Mapping[str, Any], flow: Flow | None) -> None:
    if flow is None:
        result.counts["missing"] += 1
        result.remarks.append(f"missing {label['kind']} {_shown(pair)}")
        result.counts["path lines"] += len(label.get("path_lines", ()))
        return
    if flow.kind == label["kind"]:
        result.counts[f"{flow.kind} found"] += 1
    else:
        result.counts["other kind"] += 1
        result.remarks.append(f"{flow.kind} instead of {label['kind']} {_shown(pair)}")
    needed = set(label.get("path_lines", ()))
    if not needed:
        return
    steps = {s.span.line for s in flow.steps if s.dependence != "context"}
    data = {s.span.line for s in flow.steps if s.dependence == "data"}
    allowed = needed | set(label.get("path_optional", ()))
    result.counts["path lines"] += len(needed)
    result.counts["path lines found"] += len(needed & steps)
    result.counts["data steps"] += len(data)
    result.counts["data steps labelled"] += len(data & allowed)
    if needed - steps:
        result.remarks.append(f"{_shown(pair)} lacks lines {_lines(needed - steps)}")
    if data - allowed:
        result.remarks.append(f"{_shown(pair)} has data steps not labelled: {_lines(data - allowed)}")
    if steps - data - allowed:
        result.remarks.append(
            f"{_shown(pair)} has control steps not labelled: {_lines(steps - data - allowed)}"
        )


def _shown(pair: Pair) -> str:
    return f"{pair[0]} → {pair[1]}"


def _lines(lines: set[int]) -> str:
    return ", ".join(map(str, sorted(lines)))


def directory(checkout: Path, repo: str) -> Path | None:
    """Return a repository's directory in the checkout, or None."""
    owner, _, name = repo.partition("/")
    names = (f"{owner}/{name}", f"{owner}__{name}", f"{owner}+{name}", name)
    return next((checkout / n for n in names if (checkout / n).is_dir()), None)


def read_labels(path: Path) -> list[Mapping[str, Any]]:
    """Read the labelled nodes. Exit with a message if the file does not have this format."""
    try:
        nodes = json.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        sys.exit(f"{path} cannot be read ({error.strerror}): name a labels file.")
    except ValueError as error:
        sys.exit(f"{path} is not JSON ({error}): name a labels file.")
    wanted = ("repo", "path", "flows", "sinks_without_flow")
    if not isinstance(nodes, list) or any(
        not isinstance(n, dict) or any(k not in n for k in wanted) for n in nodes
    ):
        sys.exit(f"{path} is not a labels file: it must be a list of objects with {', '.join(wanted)}.")
    return nodes


def main(arguments: Sequence[str] | None = None) -> None:
    """Print the scores."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("checkout", type=Path, help="directory that contains the repositories")
    parser.add_argument("labels", type=Path, help="labels file")
    options = parser.parse_args(arguments)
    if not options.checkout.is_dir():
        sys.exit(f"{options.checkout} is not a directory: name the one that contains the repositories.")
    total, left_out, analyses = Score(), 0, dict[Path, Analysis]()
    for node in read_labels(options.labels):
        home = directory(options.checkout, node["repo"])
        file = home / node["path"] if home is not None else None
        if home is None or file is None or not file.is_file():
            sys.exit(f"{node['repo']}: {node['path']} is not below {options.checkout}: check it out there.")
        if node.get("python2_syntax"):
            left_out += 1
            continue
        analysis = analyses.setdefault(home, analyse([home]))
        flows = [
            f for f in analysis.flows if _same(f.sink.span.path, file) and _same(f.source.span.path, file)
        ]
        one = score(node, flows)
        print(f"{node['repo']} {node['path']}: {len(flows)} flows, {len(node['flows'])} labelled")
        for remark in one.remarks:
            print(f"    {remark}")
        total.add(one)
    print(summary(total, left_out))


def _same(shown: str, file: Path) -> bool:
    return Path(shown).resolve() == file.resolve()


def summary(total: Score, left_out: int) -> str:
    """Return the table of totals."""
    rows = [f"{name:>24}: {total.counts[name]}" for name in COUNTS]
    for whole, part in SHARES:
        share = total.counts[part] / total.counts[whole] if total.counts[whole] else 1.0
        rows.append(f"{part:>24}: {total.counts[part]} of {total.counts[whole]} ({share:.0%})")
    return "\n".join(["", *rows, f"{'Python 2, left out':>24}: {left_out}"])


if __name__ == "__main__":
    main()
