"""Compare the utility as a table and with tilings, on both examples: the region, and the line ranked first.

    python benchmarks/parametric.py            # three seeds, about two minutes

The runs differ only in the tilings of the sensor x.
"""

from __future__ import annotations

import argparse
import json
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

EXAMPLES = Path(__file__).parent.parent / "examples"
CASES = (("shuttle", "test_shuttle.py::test_delivers"), ("line_follower", "test_line_follower.py"))
TILINGS = (0, 2, 3)


def main() -> None:
    """Print one row per example, seed and number of tilings."""
    parser = argparse.ArgumentParser(description="compare the tiled utility with the table")
    parser.add_argument("--seeds", type=int, default=3)
    arguments = parser.parse_args()
    print(
        "| example | seed | utility | verdict | region | same cells as the table | line ranked first by slices |"
    )
    print("|---|---|---|---|---|---|---|")
    for example, test in CASES:
        for seed in range(arguments.seeds):
            rows(example, test, seed)


def rows(example: str, test: str, seed: int) -> None:
    """Run an example with each number of tilings and print the results."""
    table: set[str] = set()
    for tilings in TILINGS:
        found = run(example, test, seed, tilings)
        region = {json.dumps(box) for box in found["region"]}
        table = table or region
        label = f"{tilings} tilings" if tilings else "table"
        first = found["culprits"][0]
        words = "; ".join(sorted(region)).replace('"', "")
        print(
            f"| {example} | {seed} | {label} | {found['verdict']['result']} | {words} | "
            f"{'yes' if region == table else 'no'} | `{first['path']}:{first['line']}` |",
            flush=True,
        )


def run(example: str, test: str, seed: int, tilings: int) -> dict[str, Any]:
    """Record an example and compare it with its drift; return the JSON result."""
    with tempfile.TemporaryDirectory() as folder:
        root = Path(folder, example)
        shutil.copytree(EXAMPLES / example, root, ignore=shutil.ignore_patterns(".tarl", "__pycache__"))
        for path in root.glob("test_*.py"):
            path.write_text(
                re.sub(r"\bbins=(\d+)", rf"bins=\1, tilings={tilings}", path.read_text("utf-8")), "utf-8"
            )
        common = [sys.executable, "-m", "pytest", "-q", test, f"--tarl-seed={seed}"]
        for mode in ("--tarl-record", "--tarl-online"):
            subprocess.run([*common, mode], cwd=root, stdout=subprocess.DEVNULL, check=False)
        (result,) = (root / ".tarl" / "results").glob("*.json")
        found: dict[str, Any] = json.loads(result.read_text("utf-8"))
        return found


if __name__ == "__main__":
    main()
