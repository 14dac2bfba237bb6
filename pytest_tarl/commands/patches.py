"""Commands for repairs: `tarl apply`, `tarl revert`, and `tarl suggest`."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from pytest_tarl.commands.parser import Parser
from pytest_tarl.printable import print_lines, printable


def add_patches(commands: argparse._SubParsersAction[Parser]) -> None:
    """Declare `tarl apply`, `tarl revert` and `tarl suggest`."""
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
    print_lines(told)
    return 0


def _revert(arguments: argparse.Namespace) -> int:
    from pytest_tarl.commands import applying

    print_lines(applying.revert(arguments.patch, arguments.directory))
    return 0


def _suggest(arguments: argparse.Namespace) -> int:
    from pytest_tarl.commands.checks import whole
    from pytest_tarl.patching import suggesting
    from pytest_tarl.patching.patch_reader import read

    forms = {"markdown": suggesting.markdown, "github": suggesting.review, "sarif": suggesting.sarif}
    patch = read(arguments.patch)
    whole([patch])
    sys.stdout.write(printable(forms[arguments.format](patch)))
    return 0
