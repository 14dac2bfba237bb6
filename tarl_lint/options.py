"""The command line: options, their meaning, and messages for mistakes."""

from __future__ import annotations

import argparse
import os
import re
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Final, NoReturn, TypeVar

from tarl_lint import __version__
from tarl_lint.errors import UsageError
from tarl_lint.read.source import LARGEST
from tarl_lint.report import FORMATS
from tarl_lint.settings.config import Options, Stdin, suggestion
from tarl_lint.settings.schema import BASELINE_NAME, FAIL_ON, check_pattern

T = TypeVar("T")

_DESCRIPTION: Final = (
    "Find every flow from a subscribed ROS topic to a published one, with the statements on its path."
)
_EPILOG: Final = (
    "Exit codes: 0 no findings that fail the run, 1 findings that do (see --fail-on), 2 invalid command line, settings "
    "or baseline, 130 interrupted. Settings are read from [tool.tarl-lint] in pyproject.toml."
)
_DASH: Final = Path("-")
DRAWN: Final = "svg"  # the format that is available for launch files only
MOST_SHOWN: Final = 100  # maximum number of flows shown individually in a text report; about ten screens


class _Help(argparse.HelpFormatter):
    """Determines the terminal width itself.

    argparse would import shutil for every added option to find the width.
    """

    def __init__(self, prog: str) -> None:
        super().__init__(prog, width=max(40, _columns() - 2))


def _columns() -> int:
    try:
        return int(os.environ.get("COLUMNS", "")) or 80
    except ValueError:
        pass
    try:
        return os.get_terminal_size(1).columns or 80
    except OSError:  # no terminal
        return 80


class _Parser(argparse.ArgumentParser):
    """Raises UsageError with a sentence instead of printing the usage and exiting."""

    def error(self, message: str) -> NoReturn:
        known = [option for action in self._actions for option in action.option_strings]
        raise UsageError(f"{_sentence(message, known)} Run tarl-lint --help for all options.")


def _sentence(message: str, known: Sequence[str]) -> str:
    """Return argparse's message as a sentence, with a suggestion."""
    if found := re.fullmatch(r"unrecognized arguments: (.*)", message):
        option = found[1].split()[0].split("=")[0]
        return f"There is no option {option}{suggestion(option, [k for k in known if k.startswith('--')])}"
    if found := re.fullmatch(r"argument (\S+): invalid choice: '([^']*)' \(choose from (.*)\)", message):
        choices = re.findall(r"[\w-]+", found[3])
        return f"{found[1]} cannot be {found[2]!r}{suggestion(found[2], choices)} It can be {', '.join(choices)}."
    if found := re.fullmatch(r"argument (\S+): expected one argument", message):
        return f"{found[1]} needs a value."
    if found := re.fullmatch(r"argument (\S+): ('.*' (?:has|is|does) .*?)\.?", message):
        return f"{found[1]}: {found[2]}."
    return message[:1].upper() + message[1:] + "."


def _codes(text: str) -> tuple[str, ...]:
    return tuple(code.strip().upper() for code in text.split(",") if code.strip())


def _patterns(text: str) -> tuple[str, ...]:
    """Split at commas, except inside the braces and brackets of patterns."""
    return tuple(_pattern(p.strip()) for p in re.split(r",(?![^\[{]*[\]}])", text) if p.strip())


def _pattern(text: str) -> str:
    try:
        return check_pattern(text)
    except ValueError as error:
        raise argparse.ArgumentTypeError(str(error)) from None


def _per_file(text: str) -> tuple[tuple[str, tuple[str, ...]], ...]:
    """Parse `PATTERN:CODES PATTERN:CODES …`, the syntax of flake8."""
    return tuple(_pair(part) for part in re.split(r"(?<=[A-Za-z0-9])\s+(?=\S+:)", text.strip()))


def _pair(text: str) -> tuple[str, tuple[str, ...]]:
    pattern, _, codes = text.rpartition(":")
    if not pattern or not _codes(codes):
        raise argparse.ArgumentTypeError(
            f"{text!r} does not have the form PATTERN:CODES, such as 'tests/:TARL1'"
        )
    return _pattern(pattern), _codes(codes)


def parser() -> argparse.ArgumentParser:
    """Return the parser of the command line."""
    made = _Parser(
        prog="tarl-lint", description=_DESCRIPTION, epilog=_EPILOG, allow_abbrev=False, formatter_class=_Help
    )
    made.add_argument(
        "paths",
        nargs="*",
        type=Path,
        metavar="PATH",
        help="files and directories (default: .); - reads standard input",
    )
    _add_system(made.add_argument_group("launch files"))
    made.add_argument("--version", action="version", version=f"tarl-lint {__version__}")
    made.add_argument("--explain", metavar="CODE", help="explain a rule, with examples, and exit")
    made.add_argument("--show-settings", action="store_true", help="show the settings in use and exit")
    _add_output(made.add_argument_group("output"))
    _add_choice(made.add_argument_group("rules and files"))
    _add_policy(made.add_argument_group("failing and the baseline"))
    _add_speed(made.add_argument_group("speed"))
    return made


class _Once(argparse.Action):
    """An option that may be given only once, since otherwise its last value would silently replace the earlier ones."""

    def __call__(
        self,
        parser: argparse.ArgumentParser,
        namespace: argparse.Namespace,
        values: object,
        option: str | None = None,
    ) -> None:
        """Store the value."""
        if getattr(namespace, self.dest) is not None:
            parser.error(
                f"{option} is given twice: run tarl-lint once for each launch file, or use {option} all"
            )
        setattr(namespace, self.dest, values)


def _add_system(group: argparse._ArgumentGroup) -> None:
    group.add_argument(
        "--launch",
        action=_Once,
        metavar="FILE",
        help="analyse the nodes of a launch file as one system; give its arguments as NAME:=VALUE; all analyses "
        "every launch file",
    )
    group.add_argument(
        "--from",
        dest="origin",
        metavar="TOPIC",
        help="show which published topics the data of this topic reaches",
    )
    group.add_argument(
        "--to",
        dest="target",
        metavar="TOPIC",
        help="show which topics reach this topic, and through which statements or nodes",
    )


def _add_output(group: argparse._ArgumentGroup) -> None:
    group.add_argument(
        "--format",
        choices=(*FORMATS, DRAWN),
        default="text",
        metavar="FORMAT",
        help=f"one of {', '.join(FORMATS)} (default: text); with --launch also {DRAWN}",
    )
    group.add_argument(
        "--show-paths", action="store_true", help="show the shortest chain of statements of every flow"
    )
    group.add_argument(
        "--all-steps", action="store_true", help="show all statements of the flows, including conditions"
    )
    group.add_argument(
        "--max-paths",
        type=_number,
        default=MOST_SHOWN,
        metavar="N",
        help=f"show at most N flows individually and count the rest; 0 shows all (default: {MOST_SHOWN})",
    )
    group.add_argument("--statistics", action="store_true", help="show statistics of the findings")
    group.add_argument("--output-file", type=Path, metavar="FILE", help="write the report to this file")


def _add_choice(group: argparse._ArgumentGroup) -> None:
    for option, meaning in (
        ("select", "enable only these rules: TARL101,TARL2 …"),
        ("extend-select", "enable these rules too, including ones that are off by default: TARL103"),
        ("ignore", "disable these rules"),
    ):
        group.add_argument(f"--{option}", action="extend", type=_codes, metavar="CODES", help=meaning)
    group.add_argument(
        "--exclude",
        action="extend",
        type=_patterns,
        metavar="PATTERNS",
        help="exclude paths, with patterns as in .gitignore: vendor/,*_gen.py; replaces the setting",
    )
    group.add_argument(
        "--extend-exclude",
        action="extend",
        type=_patterns,
        metavar="PATTERNS",
        help="exclude these paths too",
    )
    group.add_argument(
        "--per-file-ignores",
        action="extend",
        type=_per_file,
        metavar="PATTERN:CODES",
        help="disable rules in matching files: 'tests/:TARL1 *_demo.py:TARL102,TARL2'",
    )
    group.add_argument(
        "--stdin-filename", type=Path, metavar="FILE", help="path of the file whose text is on standard input"
    )
    group.add_argument(
        "--config", type=Path, metavar="FILE", help="settings file (default: nearest pyproject.toml)"
    )


def _add_policy(group: argparse._ArgumentGroup) -> None:
    group.add_argument(
        "--fail-on",
        choices=FAIL_ON,
        help="which new findings give exit code 1: none, hazards, hazards and explicit flows (default), or all",
    )
    group.add_argument(
        "--exit-zero", action="store_true", help="exit with 0 even if there are findings; overrides --fail-on"
    )
    group.add_argument(
        "--baseline", type=Path, metavar="FILE", help=f"file of accepted findings (default: {BASELINE_NAME})"
    )
    group.add_argument("--no-baseline", action="store_true", help="report accepted findings too")
    group.add_argument("--write-baseline", action="store_true", help="accept all current flows and hazards")


def _add_speed(group: argparse._ArgumentGroup) -> None:
    group.add_argument(
        "--jobs",
        type=_jobs,
        metavar="N",
        help="number of processes; auto (default): one per processor for large trees; --launch always uses one",
    )
    group.add_argument(
        "--no-cache",
        action="store_true",
        help="do not read or write the cache of results, .tarl/cache/lint",
    )


def _number(text: str) -> int:
    if not text.isdecimal():
        raise argparse.ArgumentTypeError(f"{text!r} is not a number: write 0 or more")
    return int(text)


def _jobs(text: str) -> int | None:
    if text == "auto":
        return None
    if not text.isdecimal() or int(text) == 0:
        raise argparse.ArgumentTypeError(f"{text!r} is not a number of processes: write 1 or more, or auto")
    return int(text)


def options(typed: argparse.Namespace) -> Options:
    """Return the options that influence findings. Raises UsageError for contradictions."""
    if typed.no_baseline and (typed.write_baseline or typed.baseline):
        other = "--write-baseline" if typed.write_baseline else "--baseline"
        raise UsageError(f"--no-baseline and {other} cannot be used together: omit one.")
    stdin = _stdin(typed)
    paths = tuple(stdin.path if stdin and path == _DASH else path for path in typed.paths)
    return Options(
        paths=paths or (Path(),),
        stdin=stdin,
        config=typed.config,
        select=_given(typed.select),
        extend_select=tuple(typed.extend_select or ()),
        ignore=_given(typed.ignore),
        exclude=_given(typed.exclude),
        extend_exclude=tuple(typed.extend_exclude or ()),
        baseline=typed.baseline,
        no_baseline=typed.no_baseline,
        write_baseline=typed.write_baseline,
        fail_on="never" if typed.exit_zero else typed.fail_on,
        per_file_ignores=_given(typed.per_file_ignores),
        cache=not typed.no_cache,
        jobs=typed.jobs,
    )


def _given(values: list[T] | None) -> tuple[T, ...] | None:
    return tuple(values) if values is not None else None


def _stdin(typed: argparse.Namespace) -> Stdin | None:
    """Return the text from standard input, if requested."""
    if _DASH not in typed.paths:
        if typed.stdin_filename:
            raise UsageError("--stdin-filename needs text on standard input: add - to the paths.")
        return None
    if sys.stdin is None:
        raise UsageError("Standard input is closed: omit -, or pipe the text of a file to it.")
    return Stdin(typed.stdin_filename or Path("stdin.py"), sys.stdin.buffer.read(LARGEST + 1))
