"""The command line of `tarl`: inspect recordings, observe and watch robots, apply patches."""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Iterable, Sequence
from importlib.metadata import version
from pathlib import Path

from pytest_tarl.commands.fleet import add_fleet, add_ingest, add_merge
from pytest_tarl.commands.parser import Parser
from pytest_tarl.commands.robots import add_observe, add_watch
from pytest_tarl.errors import RefusedError, TarlError
from pytest_tarl.extras import missing_extra, missing_fleet, missing_server
from pytest_tarl.printable import printable, printable_line


def main(argv: Sequence[str] | None = None) -> int:
    """Run a command. Return 0; 1 if it refuses or a check fails; 2 for a user error."""
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
        sys.stdout = open(os.devnull, "w")  # noqa: PTH123, SIM115 - discard the remaining output
        return 0
    except KeyboardInterrupt:
        print("tarl: interrupted.", file=sys.stderr)
        return 130


def _print(lines: Iterable[str]) -> None:
    """Print lines that contain untrusted text: code, topics, headers of patches."""
    print("\n".join(map(printable_line, lines)))


def parser() -> Parser:
    """Return the parser of the command line."""
    parser = Parser(prog="tarl", description="Inspect recordings, watch robots, and apply repairs of TARL.")
    parser.add_argument("--version", action="version", version=f"%(prog)s {version('tarl')}")
    commands = parser.add_subparsers(required=True, metavar="COMMAND", dest="command")
    show = commands.add_parser("show", help="show a summary of a recording")
    show.add_argument("fixture", type=Path, help="a file in .tarl/utility or .tarl/online")
    show.add_argument(
        "--sites", action="store_true", help="list the statements of every taint list, even if there are many"
    )
    show.set_defaults(run=_show)
    diff = commands.add_parser("diff", help="compare two recordings, or the margins of two revisions")
    diff.add_argument("first", help="a recording; margins, as a file or a folder; or a revision of git")
    diff.add_argument(
        "second", nargs="?", help="the same; without it, .tarl/margins is compared with that of the revision"
    )
    diff.add_argument(
        "--fail-if-worse",
        action="store_true",
        help="exit with 1 if the second one earns significantly less, or fails significantly nearer to nominal",
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
        help="of margins: text (default) or Markdown",
    )
    diff.set_defaults(run=_diff)
    summary = commands.add_parser("summary", help="print the results of the last comparisons as Markdown")
    summary.add_argument(
        "results", type=Path, nargs="?", default=Path(".tarl/results"), help="default .tarl/results"
    )
    summary.add_argument(
        "--since",
        metavar="REVISION",
        help="compare .tarl/margins beside the results with those of a revision",
    )
    summary.set_defaults(run=_summary)
    add_observe(commands)
    add_watch(commands)
    add_merge(commands)
    _add_patches(commands)
    for command in commands.choices.values():
        command.set_defaults(parser=command, needs=missing_extra)
    add_ingest(commands)
    add_fleet(commands)
    for name in ("ingest", "fleet"):
        commands.choices[name].set_defaults(parser=commands.choices[name], needs=missing_fleet)
    workspace = commands.add_parser(
        "workspace", help="list the packages of a ROS workspace, as TARL reads them"
    )
    workspace.add_argument("folder", type=Path, nargs="?", default=Path(), help="default: this folder")
    workspace.add_argument(
        "--format", choices=("text", "json"), default="text", help="default: text, a table"
    )
    workspace.set_defaults(run=_workspace, parser=workspace, needs=_nothing)
    lsp = commands.add_parser("lsp", help="run the language server for editors, on standard streams")
    lsp.set_defaults(run=_lsp, parser=lsp, needs=missing_server)
    return parser


def _summary(arguments: argparse.Namespace) -> int:
    from pytest_tarl.commands.summary import markdown

    sys.stdout.write(printable(markdown(arguments.results, arguments.since)))
    return 0


def _nothing(_: str) -> str | None:
    """Say that a command needs nothing beyond the linter."""
    return None


def _workspace(arguments: argparse.Namespace) -> int:
    from pytest_tarl.commands import workspace

    found = workspace.described(arguments.folder)
    if arguments.format == "json":
        sys.stdout.write(workspace.document(found))
    else:
        _print(workspace.table(found))
    return 0


def _lsp(_: argparse.Namespace) -> int:
    from tarl_lint import import_path

    import_path.restrict()  # import nothing from the workspace, even if the server was started there
    from pytest_tarl.editor.server import main as serve

    return serve(_applied)


def _applied(patch: Path) -> list[str]:
    from pytest_tarl.commands import applying

    return list(applying.apply([patch], None, force=False, partial=False))


def _add_patches(commands: argparse._SubParsersAction[Parser]) -> None:
    apply = commands.add_parser("apply", help="apply patches, after checking that they still fit")
    apply.add_argument(
        "--force", action="store_true", help="apply even if the file has changed or has uncommitted changes"
    )
    apply.add_argument(
        "--partial", action="store_true", help="also apply a partial repair, which was not accepted"
    )
    revert = commands.add_parser("revert", help="undo patches and keep other edits")
    suggest = commands.add_parser("suggest", help="print a patch as review suggestions or as a SARIF fix")
    suggest.add_argument(
        "--format",
        choices=("markdown", "github", "sarif"),
        default="markdown",
        help="suggestion blocks to paste (default), a review for GitHub's API, or SARIF 2.1.0",
    )
    for command in (apply, revert):
        command.add_argument("patch", type=Path, nargs="+", help="a file in .tarl/patches")
        command.add_argument(
            "--directory",
            type=Path,
            metavar="DIR",
            help="folder that the paths of a patch are relative to (default: derived from the .tarl that holds the "
            "patch)",
        )
    suggest.add_argument("patch", type=Path, help="a file in .tarl/patches")
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
    from pytest_tarl.commands.margins_files import is_recording
    from pytest_tarl.learning.fixture import load

    if arguments.second is None and is_recording(arguments.first):
        arguments.parser.error(f"name a second recording beside {arguments.first}")
    if arguments.second is None or not is_recording(arguments.first):
        return _diff_margins(arguments)
    first, second = load(Path(arguments.first)), load(Path(arguments.second))
    found = diff.compared(first, second)
    _print(diff.lines(first, second, found))
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
        _print(margins_diff.markdown(rows, "before"))
    else:
        _print([*margins_diff.lines(rows), *margins_diff.guarantees_changed(before, after)])
    return int(arguments.fail_if_worse and any(row.change == "more fragile" for row in rows))
