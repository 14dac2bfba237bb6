"""Compare the speed of `tarl-lint` with `ast.parse` and Semgrep on the same trees, in the same run.

    python benchmarks/lint_speed.py [--semgrep PATH/TO/semgrep] [--repetitions 3] TREE [TREE ...]

For each tree, the script prints the number of lines and CPU seconds: of `ast.parse` over all .py files, of tarl-lint
without a cache and with a warm cache, and of Semgrep with a taint rule from subscriber callbacks to publish calls. It
also prints the ratios of these times, and tarl-lint's peak memory. The last tree is also linted as two copies in one
run, and as four in another. CPU time and memory include child processes; each figure is the minimum of the repetitions.
Suitable public trees: checkouts of ROS repositories, Debian's `python3-ros*` packages unpacked with `dpkg -x`, wheels
from PyPI, the standard library. Python writes bytecode, as for an installed package.
"""

from __future__ import annotations

import argparse
import os
import resource
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final

RULE: Final = """rules:
  - id: callback-to-publish
    mode: taint
    languages: [python]
    severity: INFO
    message: a message reaches a publish call
    pattern-sources:
      - patterns:
          - pattern-either:
              - pattern-inside: |
                  def $CALLBACK(..., $MSG, ...):
                    ...
          - pattern: $MSG
    pattern-sinks:
      - pattern: $PUBLISHER.publish(...)
"""
PARSE: Final = """
import ast, sys, warnings
warnings.simplefilter("ignore")
for path in sys.stdin.read().split("\\n"):
    try:
        with open(path, encoding="utf-8", errors="replace") as file:
            text = file.read()
        if PARSES:
            ast.parse(text)
    except (SyntaxError, ValueError):
        pass
"""


@dataclass(frozen=True)
class Cost:
    """A command's cost: CPU seconds, and peak memory of its largest process in megabytes."""

    cpu: float
    memory: float = 0.0


def cost(command: Sequence[str], *, given: str = "", directory: Path | None = None) -> Cost:
    """Run a command; return its cost, including its children."""
    environment = {k: v for k, v in os.environ.items() if k != "PYTHONDONTWRITEBYTECODE"}
    reader, writer = os.pipe()
    child = os.fork()
    if child == 0:
        os.close(reader)
        done = subprocess.run(
            command, input=given, text=True, cwd=directory, env=environment, capture_output=True, check=False
        )
        used = resource.getrusage(resource.RUSAGE_CHILDREN)
        os.write(
            writer,
            f"{done.returncode} {used.ru_utime + used.ru_stime} {used.ru_maxrss}".encode(),
        )
        os._exit(0)
    os.close(writer)
    with os.fdopen(reader) as answer:
        code, cpu, memory = answer.read().split()
    os.waitpid(child, 0)
    if int(code) > 2:
        raise SystemExit(f"{' '.join(command)} ended with {code}.")
    return Cost(float(cpu), float(memory) / 1024)


def least(
    command: Sequence[str], repetitions: int, *, given: str = "", directory: Path | None = None
) -> Cost:
    """Return the minimum cost of several runs of a command."""
    costs = [cost(command, given=given, directory=directory) for _ in range(repetitions)]
    return Cost(min(c.cpu for c in costs), max(c.memory for c in costs))


def python_files(tree: Path) -> list[Path]:
    """Return the .py files below a tree."""
    return sorted(p for p in tree.rglob("*.py") if p.is_file())


def parsing(tree: Path, repetitions: int) -> Cost:
    """Return the cost of `ast.parse` over a tree, without starting Python and reading files."""
    names = "\n".join(str(p) for p in python_files(tree))
    bare, whole = (
        least([sys.executable, "-c", PARSE.replace("PARSES", flag)], repetitions, given=names)
        for flag in ("False", "True")
    )
    return Cost(whole.cpu - bare.cpu, whole.memory)


def linting(tree: Path, repetitions: int, *, cached: bool) -> Cost:
    """Return the cost of tarl-lint, with an empty cache or (`cached`) a full one."""
    command = [sys.executable, "-m", "tarl_lint", "--exit-zero", "--format", "concise"]
    with tempfile.TemporaryDirectory() as home:
        directory = Path(home)
        (directory / "pyproject.toml").write_text("[tool.tarl-lint]\n")
        if not cached:
            return least([*command, "--no-cache", str(tree)], repetitions, directory=directory)
        cost([*command, str(tree)], directory=directory)
        return least([*command, str(tree)], repetitions, directory=directory)


def semgrep(program: str, tree: Path) -> Cost:
    """Return the cost of Semgrep with the taint rule, in one process."""
    with tempfile.TemporaryDirectory() as home:
        rule = Path(home, "rule.yml")
        rule.write_text(RULE)
        flags = ["--metrics=off", "--disable-version-check", "--no-git-ignore", "--jobs=1", "--quiet"]
        return cost([program, "scan", "--config", str(rule), *flags, str(tree)], directory=Path(home))


def lines_of(tree: Path) -> int:
    """Return the number of lines in the .py files of a tree."""
    return sum(p.read_bytes().count(b"\n") for p in python_files(tree))


def line(name: str, tree: Path, arguments: argparse.Namespace) -> str:
    """Return a row of the table."""
    lines, parse = lines_of(tree), parsing(tree, arguments.repetitions)
    cold = linting(tree, arguments.repetitions, cached=False)
    warm = linting(tree, arguments.repetitions, cached=True)
    row = f"| {name} | {lines:,} | {parse.cpu:.2f} | {cold.cpu:.2f} | {cold.cpu / parse.cpu:.1f} |"
    row += f" {lines / cold.cpu:,.0f} | {warm.cpu:.2f} | {cold.cpu / warm.cpu:.1f} | {cold.memory:.0f} MB |"
    if arguments.semgrep:
        other = semgrep(arguments.semgrep, tree)
        row += f" {other.cpu:.1f} | {other.cpu / cold.cpu:.1f} |"
    return row


def copies(tree: Path, number: int, home: Path) -> Path:
    """Return a directory with copies of a tree, each in its own folder."""
    for copy in range(number):
        shutil.copytree(tree, home / f"copy_{copy}", dirs_exist_ok=True, ignore=_not_python)
    return home


def _not_python(directory: str, names: list[str]) -> list[str]:
    inside = Path(directory)
    return [n for n in names if not (n.endswith((".py", ".xml", ".cfg")) or (inside / n).is_dir())]


def start_up(repetitions: int) -> str:
    """Return the cost of linting one clean file, and the cost of starting Python alone."""
    with tempfile.TemporaryDirectory() as home:
        Path(home, "clean.py").write_text("def double(x):\n    return 2 * x\n")
        bare = least([sys.executable, "-c", "pass"], repetitions * 3)
        lint = [sys.executable, "-m", "tarl_lint", "--no-cache", "clean.py"]
        one = least(lint, repetitions * 3, directory=Path(home))
    return f"one clean file: {(one.cpu - bare.cpu) * 1000:.0f} ms CPU over `python -c pass`"


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("trees", nargs="+", type=Path)
    parser.add_argument("--semgrep", default="")
    parser.add_argument("--repetitions", type=int, default=3)
    parser.add_argument("--growth", type=int, nargs="*", default=[1, 2, 4])
    arguments = parser.parse_args()
    print(start_up(arguments.repetitions), flush=True)
    head = "| tree | lines | ast.parse, s | cold, s | ratio | lines per s | warm, s | cold : warm | memory |"
    print(head + (" Semgrep, s | its time : ours |" if arguments.semgrep else ""))
    for tree in arguments.trees:
        print(line(tree.name, tree.resolve(), arguments), flush=True)
    for number in arguments.growth:
        with tempfile.TemporaryDirectory() as home:
            tree = copies(arguments.trees[-1].resolve(), number, Path(home))
            print(line(f"{number} × {arguments.trees[-1].name}", tree, arguments), flush=True)


if __name__ == "__main__":
    main()
