"""The command line of `tarl`."""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Sequence
from pathlib import Path

from pytest_tarl.errors import TarlError


def main(argv: Sequence[str] | None = None) -> int:
    """Run a command; return 0, 1 where `diff --fail-if-worse` found a loss, 2 for what cannot be done."""
    arguments = _parser().parse_args(argv)
    try:
        return int(arguments.run(arguments))
    except TarlError as problem:
        print(f"tarl: {problem}", file=sys.stderr)
        return 2
    except BrokenPipeError:
        sys.stdout = open(os.devnull, "w")  # noqa: PTH123, SIM115 - what is left to print goes nowhere
        return 0
    except KeyboardInterrupt:
        print("tarl: interrupted.", file=sys.stderr)
        return 130


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="tarl", description="Look at what TARL recorded.")
    commands = parser.add_subparsers(required=True, metavar="COMMAND")
    show = commands.add_parser("show", help="tell in a screenful what a fixture holds")
    show.add_argument("fixture", type=Path, help="a file below .tarl/utility or .tarl/online")
    show.set_defaults(run=_show)
    diff = commands.add_parser("diff", help="compare two fixtures")
    diff.add_argument("first", type=Path)
    diff.add_argument("second", type=Path)
    diff.add_argument(
        "--fail-if-worse",
        action="store_true",
        help="exit with 1 when the second one earns significantly less",
    )
    diff.set_defaults(run=_diff)
    return parser


def _show(arguments: argparse.Namespace) -> int:
    from pytest_tarl.commands import show
    from pytest_tarl.learning.fixture import load

    print("\n".join(show.lines(load(arguments.fixture))))
    return 0


def _diff(arguments: argparse.Namespace) -> int:
    from pytest_tarl.commands import diff
    from pytest_tarl.learning.fixture import load

    first, second = load(arguments.first), load(arguments.second)
    found = diff.compared(first, second)
    print("\n".join(diff.lines(first, second, found)))
    return int(arguments.fail_if_worse and found.worse)
