"""The command `tarl-lint`: options in, report out, exit code."""

from __future__ import annotations

import io
import os
import sys
from argparse import Namespace
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import Final

from tarl_lint import baseline, report, runner
from tarl_lint.config import BASELINE_NAME, Config, resolve, shown
from tarl_lint.errors import LintError, OutputError
from tarl_lint.files import write_whole
from tarl_lint.options import options, parser
from tarl_lint.report import paint, summary
from tarl_lint.report.line import Line, View, plain
from tarl_lint.runner import Result

FOUND: Final = 1
UNUSABLE: Final = 2
INTERRUPTED: Final = 130


def main(arguments: Sequence[str] | None = None) -> int:
    """Run `tarl-lint` and return its exit code."""
    try:
        return _run(parser().parse_args(arguments))
    except LintError as error:
        print(f"tarl-lint: {error}", file=sys.stderr)
        return UNUSABLE
    except KeyboardInterrupt:
        print("tarl-lint: interrupted.", file=sys.stderr)
        return INTERRUPTED


def _run(typed: Namespace) -> int:
    if typed.explain is not None:
        _print(_explanation(typed.explain))
        return 0
    chosen = options(typed)
    config = resolve(chosen)
    if config.select or config.ignore:
        _check_codes(config)
    if typed.show_settings:
        _print(_settings(config))
        return 0
    result = runner.run(chosen, config)
    if typed.write_baseline:
        _print(_accept(result, config))
        return 0
    _show(typed, result)
    return FOUND if runner.exceeds(result, config) else 0


def _explanation(code: str) -> Iterator[Line]:
    from tarl_lint.explain import explanation  # brings the rules, which most runs need not describe

    return explanation(code)


def _check_codes(config: Config) -> None:
    """Refuse codes that no rule has, wherever they come from."""
    from tarl_lint.explain import check_codes

    for key, codes in (("select", config.select), ("ignore", config.ignore)):
        origin = dict(config.origins)[key]
        check_codes(codes, f"--{key}" if origin == "command line" else f"{origin}: {key!r}")


def _show(typed: Namespace, result: Result) -> None:
    """Print the report, or write it to a file; what a document has no place for goes to the error stream."""
    if typed.output_file:
        view = View(show_paths=typed.show_paths, statistics=typed.statistics)
        _write_file(typed.output_file, report.render(typed.format, result, view))
    else:
        view = View(
            show_paths=typed.show_paths,
            statistics=typed.statistics,
            width=paint.width_of(sys.stdout),
            glyphs=paint.glyphs_for(sys.stdout),
        )
        _print(report.render(typed.format, result, view))
    if typed.format not in report.FOR_PEOPLE:
        for line in (*summary.vanished(result, view), *summary.unused(result)):
            print(plain(line), file=sys.stderr)


def _print(lines: Iterable[Line]) -> None:
    """Write to the standard output. When whoever reads it has gone away, say nothing."""
    try:
        paint.write(lines, sys.stdout, colour=paint.wants_colour(sys.stdout))
        sys.stdout.flush()
    except BrokenPipeError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())  # or Python complains when it ends


def _write_file(path: Path, lines: Iterable[Line]) -> None:
    text = io.StringIO()
    paint.write(lines, text, colour=False)
    try:
        write_whole(path, text.getvalue())
    except OSError as error:
        raise OutputError(f"The report cannot be written to {path.as_posix()}: {error.strerror}.") from None


def _accept(result: Result, config: Config) -> Iterator[Line]:
    """Write the baseline and yield what changed."""
    path = config.baseline or Path(BASELINE_NAME)
    written = baseline.merged(result.found, result.kept)
    baseline.save(path, written)
    total = sum(entry.count for entry in written.entries)
    new = sum(f.flow is not None for f in result.new)
    parts = [f"{new} new", f"{sum(e.count for e in result.vanished)} forgotten"]
    if kept := sum(e.count for e in result.kept):
        parts.append(f"{kept} kept of files that were not read")
    yield ((f"{shown(path)}: {summary.many(total, 'flow')} accepted ({', '.join(parts)}).", "strong"),)
    if result.errors:
        yield from summary.not_analysed(result)


def _settings(config: Config) -> Iterator[Line]:
    """Yield the settings in use, as they would stand in a settings file, and where each comes from."""
    origins = dict(config.origins)
    values = {
        "select": list(config.select),
        "ignore": list(config.ignore),
        "exclude": list(config.exclude),
        "baseline": shown(config.baseline) if config.baseline else "",
        "sanitizers": list(config.sanitizers),
        "fail-on": config.fail_on,
    }
    yield ((f"# settings file: {shown(config.file) if config.file else 'none'}", "quiet"),)
    yield ((f"# relative to:   {(config.root or Path.cwd()).as_posix()}", "quiet"),)
    for key, value in values.items():
        text = f"{key} = {_toml(value)}"
        yield ((f"{text:<40}", ""), (f"  # {origins.get(key, 'default')}", "quiet"))


def _toml(value: Sequence[str]) -> str:
    import json  # strings and lists of them are written alike

    return json.dumps(value, ensure_ascii=False)
