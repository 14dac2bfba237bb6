"""The command `tarl-lint`: read the options, write the report, return the exit code."""

from __future__ import annotations

import gc
import io
import os
import sys
from argparse import Namespace
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Final, TextIO, TypeVar

from tarl_lint import baseline, report
from tarl_lint.errors import LintError, OutputError, UsageError
from tarl_lint.files import shown, write_atomically
from tarl_lint.options import DRAWN, options, parser
from tarl_lint.report import closing_lines, paint
from tarl_lint.report.line import Line, View, plain
from tarl_lint.run import runner
from tarl_lint.run.progress import Tell, silent
from tarl_lint.run.runner import Result
from tarl_lint.settings.config import Config, Options, resolve
from tarl_lint.settings.schema import BASELINE_NAME

T = TypeVar("T")

FOUND: Final = 1
UNUSABLE: Final = 2
INTERRUPTED: Final = 130


def main(arguments: Sequence[str] | None = None) -> int:
    """Run `tarl-lint` and return its exit code. Without `arguments`, use those of the command line."""
    if arguments is not None:
        return _guarded(arguments)
    gc.disable()
    _open_streams()
    code = _guarded(None)
    gc.freeze()  # without this, Python's garbage collector traverses all objects at exit
    return code


def _open_streams() -> None:
    """Open the null device for standard streams that the parent process closed (None in Python)."""
    for name in ("stdout", "stderr"):
        if getattr(sys, name) is None:
            setattr(sys, name, Path(os.devnull).open("w", encoding="utf-8"))  # noqa: SIM115 - stays open until the process ends


def _guarded(arguments: Sequence[str] | None) -> int:
    try:
        return _run(parser().parse_args(arguments))
    except LintError as error:
        print(paint.harmless(f"tarl-lint: {error}"), file=sys.stderr)
        return UNUSABLE
    except KeyboardInterrupt:
        if arguments is None:
            from tarl_lint.run.interrupts import over

            over()
        print("tarl-lint: interrupted.", file=sys.stderr)
        return INTERRUPTED


def _run(typed: Namespace) -> int:
    if typed.explain is not None:
        _print(_explanation(typed.explain))
        return 0
    if typed.launch is not None or typed.origin or typed.target:
        return _launched(typed)
    if typed.format == DRAWN:
        raise UsageError(f"--format {DRAWN} draws the nodes of launch files: add --launch.")
    chosen = options(typed)
    config = resolve(chosen)
    _check(config)
    if typed.show_settings:
        _print(_settings(config))
        return 0
    if config.select and all(code.startswith(runner.ARCHITECTURE) for code in config.select):
        raise UsageError(
            f"select names only rules about launch files ({', '.join(config.select)}): add --launch FILE, or "
            "--launch all."
        )
    result = _lint(chosen, config)
    if typed.write_baseline:
        _print(_accept(result, config))
        return 0
    _show(typed, result, lambda view: report.render(typed.format, result, view))
    return FOUND if runner.exceeds(result, config) else 0


def _launched(typed: Namespace) -> int:
    """Report the systems of launch files."""
    from tarl_lint.system import command
    from tarl_lint.system.as_result import as_result

    if typed.stdin_filename is not None or Path("-") in typed.paths:
        raise UsageError(
            "--launch, --from and --to analyse the files of a workspace, not standard input: omit - and "
            "--stdin-filename."
        )
    asked = command.request(typed.launch, typed.paths, typed.origin, typed.target)
    typed.paths = [asked.root]
    chosen = options(typed)
    config = resolve(chosen)
    _check(config)
    if typed.show_settings:
        _print(_settings(config))
        return 0
    made = _with_progress(lambda tell: command.systems(asked, config, tell, cached=chosen.cache))
    found = command.judged(made, config, writing=typed.write_baseline)
    gone = command.vanished(found, asked, config)
    if typed.write_baseline:
        path, written = command.accepted(found, config, gone)
        baseline.save(path, written)
        _print([((f"{shown(path)}: {closing_lines.numbers(written)} accepted.", "strong"),)])
        return 0
    result = as_result(found, config, gone)
    _show(typed, result, lambda view: command.rendered(typed.format, found, asked, view, result))
    return FOUND if runner.exceeds(result, config) else 0


def _settings(config: Config) -> Iterator[Line]:
    from tarl_lint.report.settings import settings

    return settings(config)


def _explanation(code: str) -> Iterator[Line]:
    from tarl_lint.explain import explanation  # imports the rules' texts, which most runs do not need

    return explanation(code)


def _lint(chosen: Options, config: Config) -> Result:
    """Run the linter."""
    return _with_progress(lambda tell: runner.run(chosen, config, tell))


def _with_progress(work: Callable[[Tell], T]) -> T:
    """Run a long computation, and show its progress on a terminal."""
    if not sys.stderr.isatty():
        return work(silent)
    from tarl_lint.run.progress import Progress

    with Progress(sys.stderr) as progress:
        return work(lambda text: progress.tell(paint.harmless(text)))


def _check(config: Config) -> None:
    """Raise UsageError for unknown rule codes and for wrappers of functions that ROS does not have."""
    per_file = tuple(code for _, codes in config.per_file_ignores for code in codes)
    chosen = (
        ("select", config.select),
        ("extend-select", config.extend_select),
        ("ignore", config.ignore),
        ("per-file-ignores", per_file),
    )
    for key, codes in chosen:
        if codes:
            from tarl_lint.explain import check_codes

            origin = dict(config.origins)[key]
            check_codes(codes, f"--{key}" if origin == "command line" else f"{origin}: {key!r}")
    if config.wrappers:
        from tarl_lint.settings.wrappers import facts

        facts(config.wrappers)


def _show(typed: Namespace, result: Result, render: Callable[[View], Iterable[Line]]) -> None:
    """Print the report, or write it to a file.

    Information that does not fit into the format goes to standard error.
    """
    if typed.output_file:
        view = _view(typed)
        _write_file(typed.output_file, render(view))
    else:
        view = _view(typed, sys.stdout)
        _print(render(view))
    if typed.format not in report.FOR_PEOPLE:
        for line in (
            *closing_lines.vanished(result, view),
            *closing_lines.unused(result),
            *closing_lines.unmatched(result),
        ):
            print(paint.harmless(plain(line)), file=sys.stderr)


def _view(typed: Namespace, stream: TextIO | None = None) -> View:
    """Return the display settings; if the report goes to a terminal, use the settings of the terminal."""
    view = View(
        show_paths=typed.show_paths or typed.all_steps,
        all_steps=typed.all_steps,
        most_flows=typed.max_paths,
        statistics=typed.statistics,
    )
    if stream is None:
        return view
    return replace(view, width=paint.width_of(stream), glyphs=paint.glyphs_for(stream))


def _print(lines: Iterable[Line]) -> None:
    """Write to standard output. If the reader has closed the stream, stop silently.

    Raises OutputError if writing fails, as on a full disk.
    """
    try:
        paint.write(lines, sys.stdout, colour=paint.wants_colour(sys.stdout))
        sys.stdout.flush()
    except BrokenPipeError:
        _give_up_output()
    except OSError as error:
        _give_up_output()
        raise OutputError(f"Cannot write the report to standard output: {error.strerror}.") from None


def _give_up_output() -> None:
    """Discard the remaining output, since Python would otherwise report an error at exit."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def _write_file(path: Path, lines: Iterable[Line]) -> None:
    text = io.StringIO()
    paint.write(lines, text, colour=False)
    try:
        write_atomically(path, text.getvalue().encode("utf-8", "surrogateescape"), through_links=True)
    except OSError as error:
        raise OutputError(f"The report cannot be written to {path.as_posix()}: {error.strerror}.") from None


def _accept(result: Result, config: Config) -> Iterator[Line]:
    """Write the baseline and yield what changed."""
    path = config.baseline or Path(BASELINE_NAME)
    written = baseline.merged(result.found, result.kept)
    baseline.save(path, written)
    parts = [f"{len(result.new)} new", f"{sum(e.count for e in result.vanished)} removed"]
    if kept := sum(e.count for e in result.kept):
        parts.append(f"{kept} kept from files that this run did not analyse")
    yield ((f"{shown(path)}: {closing_lines.numbers(written)} accepted ({', '.join(parts)}).", "strong"),)
    if result.errors:
        yield from closing_lines.not_analysed(result)
