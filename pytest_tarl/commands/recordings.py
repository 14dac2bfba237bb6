"""Commands for recordings and comparisons: `tarl show`, `tarl diff` and `tarl summary`."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from pytest_tarl.commands.parser import Parser
from pytest_tarl.printable import print_lines, printable


def add_show(commands: argparse._SubParsersAction[Parser]) -> None:
    """Declare `tarl show`."""
    show = commands.add_parser("show", help="show a summary of a recording")
    show.add_argument("fixture", type=Path, help="a file in .tarl/utility or .tarl/online")
    show.add_argument(
        "--sites", action="store_true", help="list the statements of every taint list, even if there are many"
    )
    show.set_defaults(run=_show)


def _show(arguments: argparse.Namespace) -> int:
    from pytest_tarl.commands import show
    from pytest_tarl.learning.fixture import load, sizes

    path: Path = arguments.fixture
    fixture = load(path)
    own = sizes(path, len(fixture.lists))
    print_lines(show.lines(fixture, path.stat().st_size, own, every=arguments.sites))
    return 0


def add_diff(commands: argparse._SubParsersAction[Parser]) -> None:
    """Declare `tarl diff`."""
    diff = commands.add_parser("diff", help="compare two recordings, or the margins of two revisions")
    diff.add_argument("first", help="a recording; margins, as a file or a folder; or a revision of git")
    diff.add_argument(
        "second",
        nargs="?",
        help=(
            "the second recording, margins or revision; if omitted, .tarl/margins is compared with the "
            "margins at the revision FIRST"
        ),
    )
    diff.add_argument(
        "--fail-if-worse",
        action="store_true",
        help=(
            "exit with 1 if the second recording earns significantly less or succeeds significantly less often, or "
            "if a failure boundary of the second margins is significantly nearer to the nominal point"
        ),
    )
    diff.add_argument(
        "--max-loss",
        metavar="R",
        type=float,
        default=0.0,
        help="with --fail-if-worse: tolerated loss of reward per episode (default 0)",
    )
    diff.add_argument(
        "--alpha", metavar="P", type=float, help="with --fail-if-worse: rate of false alarms (default 0.05)"
    )
    diff.add_argument(
        "--fail-if-changed",
        action="store_true",
        help="exit with 1 if a recorded statement was edited or the sensors differ",
    )
    diff.add_argument(
        "--format",
        choices=("text", "markdown"),
        default="text",
        help="format of a comparison of margins: text (default) or Markdown",
    )
    diff.set_defaults(run=_diff)


def _diff(arguments: argparse.Namespace) -> int:
    from pytest_tarl.commands import diff
    from pytest_tarl.commands.margins_files import is_recording
    from pytest_tarl.learning.fixture import load

    if arguments.second is None and is_recording(arguments.first):
        arguments.parser.error(f"name a second recording to compare with {arguments.first}")
    if arguments.second is None or not is_recording(arguments.first):
        return _diff_margins(arguments)
    first, second = load(Path(arguments.first)), load(Path(arguments.second))
    found = diff.compared(first, second)
    print_lines(diff.lines(first, second, found))
    alpha = diff.SIGNIFICANT if arguments.alpha is None else arguments.alpha
    worse = arguments.fail_if_worse and found.worse(alpha, arguments.max_loss)
    return int(worse or (arguments.fail_if_changed and found.changed))


def _diff_margins(arguments: argparse.Namespace) -> int:
    from pytest_tarl.commands import margins_diff
    from pytest_tarl.commands.margins_files import FOLDER, margins_in
    from pytest_tarl.stressing.margin_changes import compared

    given: tuple[str, str | None] = (arguments.first, arguments.second)
    places = (given[0], given[1]) if given[1] is not None else (f"{given[0]}:{FOLDER}", FOLDER)
    before, after = margins_in(places[0]), margins_in(places[1])
    rows = compared(before, after)
    if arguments.format == "markdown":
        print_lines(margins_diff.markdown(rows, "before"))
    else:
        print_lines([*margins_diff.lines(rows), *margins_diff.guarantees_changed(before, after)])
    return int(arguments.fail_if_worse and any(row.change == "more fragile" for row in rows))


def add_summary(commands: argparse._SubParsersAction[Parser]) -> None:
    """Declare `tarl summary`."""
    summary = commands.add_parser("summary", help="print the results of the last comparisons as Markdown")
    summary.add_argument(
        "results", type=Path, nargs="?", default=Path(".tarl/results"), help="default .tarl/results"
    )
    summary.add_argument(
        "--since",
        metavar="REVISION",
        help="compare the margins in .tarl/margins with those at this git revision",
    )
    summary.set_defaults(run=_summary)


def _summary(arguments: argparse.Namespace) -> int:
    from pytest_tarl.commands.summary import markdown

    sys.stdout.write(printable(markdown(arguments.results, arguments.since)))
    return 0
