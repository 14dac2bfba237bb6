"""Commands for fleets: `tarl merge`."""

from __future__ import annotations

import argparse
from pathlib import Path

from pytest_tarl.commands.parser import Parser
from pytest_tarl.printable import printable_line


def add_merge(commands: argparse._SubParsersAction[Parser]) -> None:
    """Declare `tarl merge`."""
    merge = commands.add_parser(
        "merge", help="merge recordings of a test and logs of robots into one recording"
    )
    flag = merge.add_argument
    flag("files", type=Path, nargs="+", metavar="FILE", help="recordings (.npz) and logs of `tarl observe`")
    flag("--to", type=Path, required=True, metavar="FILE", help="recording to write")
    flag(
        "--fixture",
        type=Path,
        metavar="FILE",
        help="recording whose sensors and statements are used; its episodes do not count (default: the first FILE)",
    )
    merge.set_defaults(run=_merge)


def _merge(arguments: argparse.Namespace) -> int:
    from pytest_tarl.fleet import merged
    from pytest_tarl.learning import fixture as fixtures

    fixtures.prepare(arguments.to)
    recording, parts = merged.merged(arguments.files, arguments.fixture)
    fixtures.save(recording, arguments.to)
    for line in merged.lines(arguments.to, recording, parts):
        print(printable_line(line))
    return 0
