"""The command line of `tarl`: inspect recordings, observe and watch robots, apply patches."""

from __future__ import annotations

import argparse
import errno
import io
import os
import sys
from collections.abc import Sequence
from importlib.metadata import version
from pathlib import Path

from pytest_tarl.commands.fleet import add_fleet, add_ingest, add_merge
from pytest_tarl.commands.parser import Parser
from pytest_tarl.commands.patches import add_patches
from pytest_tarl.commands.recordings import add_diff, add_show, add_summary
from pytest_tarl.commands.robots import add_observe, add_watch
from pytest_tarl.errors import RefusedError, TarlError
from pytest_tarl.extras import missing_extra, missing_fleet, missing_server
from pytest_tarl.printable import print_lines, printable

_FULL = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG, errno.EIO)  # errno values of a full or failing disk


def main(argv: Sequence[str] | None = None) -> int:
    """Run a command; return 0, or 1 for a failed check, or 2 for a user error."""
    _prepare_streams()
    arguments = parser().parse_args(argv)
    sentence = arguments.needs(f"tarl {arguments.command}")
    if sentence is not None:
        print(f"tarl: {sentence}", file=sys.stderr)
        return 2
    try:
        code = int(arguments.run(arguments))
        sys.stdout.flush()
    except RefusedError as refused:
        print(printable(f"tarl: {refused}"), file=sys.stderr)
        return 1
    except TarlError as problem:
        print(printable(f"tarl: {problem}"), file=sys.stderr)
        return 2
    except BrokenPipeError:
        _discard_output()
        return 0
    except OSError as problem:
        if problem.filename is not None or problem.errno not in _FULL:
            raise
        _discard_output()
        print(f"tarl: Cannot write to standard output: {problem.strerror}.", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        print("tarl: interrupted.", file=sys.stderr)
        return 130
    return code


def _prepare_streams() -> None:
    """Repair closed standard streams and their encodings."""
    for name in ("stdout", "stderr"):
        stream = getattr(sys, name)
        if stream is None:
            setattr(sys, name, Path(os.devnull).open("w", encoding="utf-8"))  # noqa: SIM115 - open until the end
        elif isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")


def _discard_output() -> None:
    """Discard the remaining output; otherwise Python reports an error at exit."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def parser() -> Parser:
    """Return the parser of the command line."""
    parser = Parser(prog="tarl", description="Inspect recordings, watch robots, and apply repairs of TARL.")
    parser.add_argument("--version", action="version", version=f"%(prog)s {version('tarl')}")
    parser.passing = frozenset({"observe"})
    commands = parser.add_subparsers(required=True, metavar="COMMAND", dest="command")
    add_show(commands)
    add_diff(commands)
    add_summary(commands)
    add_observe(commands)
    add_watch(commands)
    add_merge(commands)
    add_patches(commands)
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


def _nothing(_: str) -> str | None:
    """Return None: the command needs no extra packages."""
    return None


def _workspace(arguments: argparse.Namespace) -> int:
    from pytest_tarl.commands import workspace

    found = workspace.described(arguments.folder)
    if arguments.format == "json":
        sys.stdout.write(workspace.document(found))
    else:
        print_lines(workspace.table(found))
    return 0


def _lsp(_: argparse.Namespace) -> int:
    from tarl_lint import import_path

    import_path.restrict()  # never import modules from the workspace, even when started there
    from pytest_tarl.editor.server import main as serve

    return serve(_applied)


def _applied(patch: Path) -> list[str]:
    from pytest_tarl.commands import applying

    return list(applying.apply([patch], None, force=False, partial=False))
