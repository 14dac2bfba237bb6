"""Measure the latency of the language server: for a whole tree, and after edits of one file.

    python benchmarks/editing.py TREE [--files 12] [--seed 0] [--all]

Files are drawn from those with a diagnostic; with --all, from all files. Each file gets three edits: a comment before a
random statement, a statement in a random function, and a statement at the end. Two times are printed, in CPU seconds of
the linter: until all findings are known, and until those of the edited file are. The language server protocol adds only
milliseconds.
"""

from __future__ import annotations

import argparse
import ast
import os
import random
import time
from collections.abc import Mapping
from pathlib import Path

from tarl_lint.editing import Result, Workspace

GOAL = 1.0  # maximum latency (s)


def main() -> None:
    """Print the times."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else "")
    parser.add_argument("tree", type=Path)
    parser.add_argument("--files", type=int, default=12, help="files to edit, drawn by the seed")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument(
        "--all", action="store_true", help="draw from all files, not only from those with a diagnostic"
    )
    asked = parser.parse_args()
    root = asked.tree.resolve()
    os.chdir(root)
    workspace = Workspace([root])

    def timed(buffers: Mapping[Path, str], edited_path: str = "") -> tuple[float, float, Result]:
        """Return the seconds until the edited file's findings are final, the seconds for all files, and the result."""
        begun = time.process_time()
        finals: list[float] = []

        def early(_: Result, settled: frozenset[str]) -> None:
            if edited_path in settled:
                finals.append(time.process_time() - begun)

        result = workspace.lint(buffers, early=early)
        whole = time.process_time() - begun
        return min([*finals, whole]), whole, result

    _, first, result = timed({})
    lines = sum(text.count("\n") for text in result.texts.values())
    print(f"{len(result.texts)} files, {lines} lines, {len(result.findings)} findings: {first:.2f} s")
    print(f"nothing changed: {timed({})[1]:.2f} s")
    found = sorted({finding.span.path for finding in result.findings})
    places = found if found and not asked.all else sorted(result.texts)
    rng = random.Random(asked.seed)
    chosen = rng.sample(places, min(asked.files, len(places)))
    for kind in ("comment", "function", "end"):
        taken = []
        for path in chosen:
            final, whole, _ = timed({root / path: edited(result.texts[path], kind, rng)}, path)
            taken.append((whole, final, path))
            timed({})
        taken.sort()
        slow = [one for one in taken if one[0] > GOAL]
        middle = taken[len(taken) // 2][0]
        late = sum(final > GOAL for _, final, _ in taken)
        print(f"{kind}: {len(taken)} edits, median {middle:.2f} s, {len(slow)} above {GOAL} s")
        print(f"    the edited file's own findings: {late} above {GOAL} s")
        for whole, final, path in slow:
            print(f"    {whole:.2f} s, own findings after {final:.2f} s: {path}")


def edited(text: str, kind: str, rng: random.Random) -> str:
    """Return a text with one line added; if it has no function, a statement is added at the end."""
    lines = text.split("\n")
    statements = [node for node in ast.walk(ast.parse(text)) if isinstance(node, ast.stmt)]
    functions = [node for node in statements if isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef))]
    if kind == "comment" and statements:
        place = _first_line(rng.choice(statements))
        return "\n".join([*lines[:place], "# edited", *lines[place:]])
    if kind == "function" and functions:
        last = rng.choice(functions).body[-1]
        place = _first_line(last)
        return "\n".join([*lines[:place], " " * last.col_offset + "edited = 1", *lines[place:]])
    return text + "\nEDITED = 1\n"


def _first_line(statement: ast.stmt) -> int:
    """Return the index of a statement's first line, including decorators."""
    decorators: list[ast.expr] = getattr(statement, "decorator_list", [])
    return min([statement.lineno, *(one.lineno for one in decorators)]) - 1


if __name__ == "__main__":
    main()
