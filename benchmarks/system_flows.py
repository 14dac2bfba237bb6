"""Compare the flows of launched nodes with judgements made from the code before anyone saw the report.

    python benchmarks/system_flows.py TREES [--judged benchmarks/system_flows_2.json]

TREES has a folder `owner+name` for each judged repository, at the commit named in the judgements. For the launch file
"", all nodes of the tree are analysed without launch files. A judgement (node, topic, topic, kind) says that, in this
node, the first topic influences the second. Flows of nodes that are not Python are not judged. A flow is right if node,
topics and kind agree.
"""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from tarl_lint.settings.config import Options, resolve
from tarl_lint.system.command import Request, systems

JUDGED = Path(__file__).with_suffix(".json")
Flow = tuple[str, str, str]


def main() -> int:
    """Print the figures for each launch file, and for all together."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("trees", type=Path)
    parser.add_argument("--judged", type=Path, default=JUDGED)
    parser.add_argument("--show", action="store_true", help="print every flow that is not right")
    options = parser.parse_args()
    right = every = 0
    for place, rows in _launches(json.loads(options.judged.read_text("utf-8")), options.trees):
        wanted = {(node, source, sink): kind for node, source, sink, kind in rows}
        found = _found(place, options.trees)
        good = [flow for flow in wanted if found.get(flow) == wanted[flow]]
        both = wanted.keys() | found.keys()
        right, every = right + len(good), every + len(both)
        print(f"{place.name}: {len(wanted)} judged, {len(found)} reported, {len(good)} right")
        for flow in sorted(both - set(good)) if options.show else ():
            print(f"    {' · '.join(flow)}: judged {wanted.get(flow, '-')}, reported {found.get(flow, '-')}")
    print(f"right: {right} of {every} ({100 * right / max(every, 1):.1f} %)")
    return 0


def _launches(judged: Mapping[str, Any], trees: Path) -> Iterator[tuple[Path, list[list[str]]]]:
    for repository, data in judged.items():
        tree = trees / repository.replace("/", "+")
        if not tree.is_dir():
            print(f"{tree}: not found, skipped", file=sys.stderr)
            continue
        for file, rows in data["launch"].items():
            yield tree / file, rows


def _found(launch: Path, trees: Path) -> dict[Flow, str]:
    """Return the reported flows of the nodes that were read, with their kinds."""
    tree = trees / launch.relative_to(trees).parts[0]
    asked = Request("" if launch == tree else str(launch), paths=(tree,))
    return {
        (hop.node, hop.source, hop.sink): hop.kind
        for system in systems(asked, resolve(Options()))
        for hop in system.hops
        if hop.kind != "not read"
    }


if __name__ == "__main__":
    sys.exit(main())
