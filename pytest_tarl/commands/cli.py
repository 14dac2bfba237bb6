"""The command line of `tarl`: fixtures to look at, robots to observe and watch, patches to apply."""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Iterable, Sequence
from importlib.metadata import version
from pathlib import Path

from pytest_tarl.commands.parser import Parser
from pytest_tarl.commands.robots import add_observe, add_watch
from pytest_tarl.errors import RefusedError, TarlError
from pytest_tarl.extras import missing_extra, missing_server
from pytest_tarl.printable import printable, printable_line


def main(argv: Sequence[str] | None = None) -> int:
    """Run a command; return 0, 1 where it found what it was told to fail on or refused, 2 for what cannot be done."""
    arguments = parser().parse_args(argv)
    sentence = arguments.needs(f"tarl {arguments.command}")
    if sentence is not None:
        print(f"tarl: {sentence}", file=sys.stderr)
        return 2
    try:
        return int(arguments.run(arguments))
    except RefusedError as refused:
        print(printable(f"tarl: {refused}"), file=sys.stderr)
        return 1
    except TarlError as problem:
        print(printable(f"tarl: {problem}"), file=sys.stderr)
        return 2
    except BrokenPipeError:
        sys.stdout = open(os.devnull, "w")  # noqa: PTH123, SIM115 - what is left to print goes nowhere
        return 0
    except KeyboardInterrupt:
        print("tarl: interrupted.", file=sys.stderr)
        return 130


def _print(lines: Iterable[str]) -> None:
    """Print lines that hold texts of others: code, topics, headers of patches."""
    print("\n".join(map(printable_line, lines)))


def parser() -> Parser:
    """Return the parser of the command line."""
    parser = Parser(prog="tarl", description="Look at what TARL recorded, apply what it found.")
    parser.add_argument("--version", action="version", version=f"%(prog)s {version('tarl')}")
    commands = parser.add_subparsers(required=True, metavar="COMMAND", dest="command")
    show = commands.add_parser("show", help="tell in a screenful what a fixture holds")
    show.add_argument("fixture", type=Path, help="a file below .tarl/utility or .tarl/online")
    show.add_argument(
        "--sites", action="store_true", help="list the statements of every taint list, however many"
    )
    show.set_defaults(run=_show)
    diff = commands.add_parser("diff", help="compare two fixtures")
    diff.add_argument("first", type=Path)
    diff.add_argument("second", type=Path)
    diff.add_argument(
        "--fail-if-worse",
        action="store_true",
        help="exit with 1 when the second one earns significantly less",
    )
    diff.add_argument(
        "--max-loss",
        metavar="R",
        type=float,
        default=0.0,
        help="with --fail-if-worse: a loss of reward per episode that nobody minds (default 0)",
    )
    diff.add_argument(
        "--alpha", metavar="P", type=float, help="with --fail-if-worse: rate of false alarms (default 0.05)"
    )
    diff.add_argument(
        "--fail-if-changed",
        action="store_true",
        help="exit with 1 when a recorded statement was edited or the sensors are others",
    )
    diff.set_defaults(run=_diff)
    summary = commands.add_parser("summary", help="print the results of the last comparisons as Markdown")
    summary.add_argument(
        "results", type=Path, nargs="?", default=Path(".tarl/results"), help="default .tarl/results"
    )
    summary.set_defaults(run=_summary)
    add_observe(commands)
    add_watch(commands)
    _add_patches(commands)
    for command in commands.choices.values():
        command.set_defaults(parser=command, needs=missing_extra)
    lsp = commands.add_parser(
        "lsp", help="serve an editor by the Language Server Protocol, on standard streams"
    )
    lsp.set_defaults(run=_lsp, parser=lsp, needs=missing_server)
    return parser


def _summary(arguments: argparse.Namespace) -> int:
    from pytest_tarl.commands.summary import markdown

    sys.stdout.write(printable(markdown(arguments.results)))
    return 0


def _lsp(_: argparse.Namespace) -> int:
    from tarl_lint import import_path

    import_path.restrict()  # nothing of the workspace is imported, also where the server was started in it
    from pytest_tarl.editor.server import main as serve

    return serve(_applied)


def _applied(patch: Path) -> list[str]:
    from pytest_tarl.commands import applying

    return list(applying.apply([patch], None, force=False, partial=False))


def _add_patches(commands: argparse._SubParsersAction[Parser]) -> None:
    apply = commands.add_parser("apply", help="apply patches of repairs, after checking that they still fit")
    apply.add_argument(
        "--force", action="store_true", help="where the file has changed, or has changes to lose"
    )
    apply.add_argument("--partial", action="store_true", help="a partial repair, too, which was not accepted")
    revert = commands.add_parser("revert", help="undo patches of repairs, and nothing else")
    suggest = commands.add_parser(
        "suggest", help="print a patch as suggestions for a review, or as a SARIF fix"
    )
    suggest.add_argument(
        "--format",
        choices=("markdown", "github", "sarif"),
        default="markdown",
        help="suggestion blocks to read and paste (default), a review for GitHub's API, or SARIF 2.1.0",
    )
    for command in (apply, revert):
        command.add_argument("patch", type=Path, nargs="+", help="a file below .tarl/patches")
        command.add_argument(
            "--directory",
            type=Path,
            metavar="DIR",
            help="where the paths of a patch begin; known as long as the patch is below .tarl",
        )
    suggest.add_argument("patch", type=Path, help="a file below .tarl/patches")
    apply.set_defaults(run=_apply)
    revert.set_defaults(run=_revert)
    suggest.set_defaults(run=_suggest)


def _apply(arguments: argparse.Namespace) -> int:
    from pytest_tarl.commands import applying

    told = applying.apply(
        arguments.patch, arguments.directory, force=arguments.force, partial=arguments.partial
    )
    _print(told)
    return 0


def _revert(arguments: argparse.Namespace) -> int:
    from pytest_tarl.commands import applying

    _print(applying.revert(arguments.patch, arguments.directory))
    return 0


def _suggest(arguments: argparse.Namespace) -> int:
    from pytest_tarl.commands.checks import whole
    from pytest_tarl.patching import suggesting
    from pytest_tarl.patching.reading import read

    forms = {"markdown": suggesting.markdown, "github": suggesting.review, "sarif": suggesting.sarif}
    patch = read(arguments.patch)
    whole([patch])
    sys.stdout.write(printable(forms[arguments.format](patch)))
    return 0


def _show(arguments: argparse.Namespace) -> int:
    from pytest_tarl.commands import show
    from pytest_tarl.learning.fixture import load, sizes

    path: Path = arguments.fixture
    fixture = load(path)
    own = sizes(path, len(fixture.lists))
    _print(show.lines(fixture, path.stat().st_size, own, every=arguments.sites))
    return 0


def _diff(arguments: argparse.Namespace) -> int:
    from pytest_tarl.commands import diff
    from pytest_tarl.learning.fixture import load

    first, second = load(arguments.first), load(arguments.second)
    found = diff.compared(first, second)
    _print(diff.lines(first, second, found))
    alpha = diff.SIGNIFICANT if arguments.alpha is None else arguments.alpha
    worse = arguments.fail_if_worse and found.worse(alpha, arguments.max_loss)
    return int(worse or (arguments.fail_if_changed and found.changed))
