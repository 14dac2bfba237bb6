"""Measure the language server's latency: first for a tree, then after an edit of one file with a publish call.

    python benchmarks/editing.py TREE [--files 12] [--seed 0]

Times are CPU seconds of the linter; the protocol adds milliseconds.
"""

from __future__ import annotations

import argparse
import os
import random
import time
from collections.abc import Mapping
from pathlib import Path

from tarl_lint.editing import Result, Workspace


def main() -> None:
    """Print the times."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else "")
    parser.add_argument("tree", type=Path)
    parser.add_argument("--files", type=int, default=12, help="files to edit, drawn by the seed")
    parser.add_argument("--seed", type=int, default=0)
    asked = parser.parse_args()
    root = asked.tree.resolve()
    os.chdir(root)
    workspace = Workspace([root])

    def timed(buffers: Mapping[Path, str]) -> tuple[float, Result]:
        begun = time.process_time()
        result = workspace.lint(buffers)
        return time.process_time() - begun, result

    first, result = timed({})
    lines = sum(text.count("\n") for text in result.texts.values())
    print(f"{len(result.texts)} files, {lines} lines, {len(result.findings)} findings: {first:.2f} s")
    print(f"nothing changed: {timed({})[0]:.2f} s")
    places = sorted({finding.span.path for finding in result.findings}) or sorted(result.texts)
    chosen = random.Random(asked.seed).sample(places, min(asked.files, len(places)))
    taken = sorted(timed({root / path: result.texts[path] + "\nEDITED = 1\n"})[0] for path in chosen)
    print(f"after an edit: {', '.join(f'{seconds:.2f}' for seconds in taken)} s")


if __name__ == "__main__":
    main()
