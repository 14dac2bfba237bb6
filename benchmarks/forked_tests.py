"""A pytest plugin that collects tests once, then runs chosen ones in forks, with or without a fault in the code.

A fork changes the functions in the file with the fault, so nothing is imported again. It behaves like a fresh process,
provided that no changed line ran during the imports. The caller has to check this: the results of `measured` list the
lines that ran during imports under `IMPORTED`. Processes that a test starts read the changed file from disk. Needs
`os.fork`.
"""

from __future__ import annotations

import gc
import json
import os
import signal
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from types import CodeType, FrameType, FunctionType
from typing import Any, TextIO

import pytest
from reach_marks import Marks, marks
from reached_lines import Reached
from warm_pytest import ended

CHANNELS = "FORKED_TESTS"  # environment variable with the ends of two pipes, "read,write"
IMPORTED = "(import)"  # in lists of the tests that reach a line: the import of all modules
UNCHANGED = 77  # exit status if a fault cannot be put into the functions of this process
SLOWEST = 1.0  # a measured test is interrupted after this many CPU seconds
# limits for measuring one test file, as multiples of SLOWEST: CPU seconds, and wall seconds on a busy machine
MOST_OF_FILE, LONGEST_FILE = 2.5, 45.0


@dataclass(frozen=True)
class Ran:
    """The result of a fork: exit status ("timeout" if killed), and the last test begun, if not all passed.

    `started` has the tests that began, in order.
    """

    status: str
    failed: str
    started: tuple[str, ...]


class Forks:
    """Runs tests in forks of a pytest process that has already collected them."""

    def __init__(self, requests: int, answers: int, output: Path) -> None:
        self._requests = os.fdopen(requests, "w")
        self._answers = os.fdopen(answers)
        self._output = output
        first = self._answers.readline()
        if not first:
            self.close()
            raise EOFError
        self.tests: list[str] = json.loads(first)

    def __call__(self, tests: Sequence[str], limit: float, path: str = "", line: int = 0) -> Ran:
        """Run tests until one fails, with the current text of the file `path`.

        `line` is the first line that differs from the imported text. The fork, and the processes that it started, are
        killed after `limit` seconds.
        """
        status, lines = self._asked(
            {"tests": [*tests], "limit": limit, "path": path, "line": line, "slowest": 0.0}
        )
        started = tuple(one["test"] for one in lines if one["passed"] is None)
        passed = {one["test"] for one in lines if one["passed"]}
        failed = next((one for one in reversed(started) if one not in passed), "")
        return Ran(status, failed, started)

    def measured(self, slowest: float = SLOWEST) -> Reached:
        """Run all tests once, in one fork per file, and return the lines that they reach.

        The pytest process must have marks (see `reach_marks.py`). A test is interrupted after `slowest` CPU seconds.
        Once a file has taken MOST_OF_FILE times as many, its remaining tests are skipped.
        """
        files: dict[str, list[str]] = {}
        for test in self.tests:
            files.setdefault(test.partition("::")[0], []).append(test)
        found = Reached([IMPORTED])
        left_out = 0
        for number, tests in enumerate([[], *files.values()]):
            _, lines = self._asked(
                {"tests": tests, "limit": LONGEST_FILE * slowest, "path": "", "line": 0, "slowest": slowest}
            )
            _add(found, lines)
            left_out += len(tests) - sum(one["passed"] is not None for one in lines if one["test"])
            print(
                f"{number} of {len(files)} files measured, {left_out} tests left out",
                file=sys.stderr,
                flush=True,
            )
        return found

    def close(self) -> None:
        """End the pytest process."""
        self._requests.close()
        self._answers.close()

    def _asked(self, request: Mapping[str, object]) -> tuple[str, list[dict[str, Any]]]:
        print(json.dumps({**request, "output": str(self._output)}), file=self._requests, flush=True)
        status = self._answers.readline().strip()
        lines = self._output.read_text().splitlines()
        return status, [json.loads(one) for one in lines if one.endswith("}")]


def _add(found: Reached, lines: Sequence[Mapping[str, Any]]) -> None:
    for one in lines:
        if one["passed"] is None:
            continue
        test = one["test"] or IMPORTED
        if test != IMPORTED:
            found.tests.append(test)
        bit = 1 << found.tests.index(test)
        if one["passed"] and test != IMPORTED:
            found.seconds[test] = one["seconds"]
        for path, numbers in one["lines"]:
            for line in numbers:
                found.lines[path, line] = found.lines.get((path, line), 0) | bit


@contextmanager
def forks(folder: Path, environment: Mapping[str, str], arguments: Sequence[str]) -> Iterator[Forks]:
    """Start pytest with these arguments in the folder, and end it afterwards.

    Raise EOFError if pytest ends during collection.
    """
    (read, asking), (answering, write) = os.pipe(), os.pipe()
    with tempfile.TemporaryDirectory(prefix="forks-") as place:
        command = [
            sys.executable,
            "-m",
            "pytest",
            "-q",
            "-p",
            "forked_tests",
            "-p",
            "no:cacheprovider",
            "--assert=plain",
        ]
        command += ["--basetemp", str(Path(place) / "base"), *arguments]
        surroundings = {**environment, CHANNELS: f"{read},{write}"}
        surroundings["PYTHONPATH"] = os.pathsep.join(
            [environment.get("PYTHONPATH", ""), str(Path(__file__).parent)]
        )
        with (
            (Path(place) / "log").open("w+b") as log,
            subprocess.Popen(
                command,
                cwd=folder,
                env=surroundings,
                stdin=subprocess.DEVNULL,
                stdout=log,
                stderr=log,
                pass_fds=(read, write),
            ),
        ):
            os.close(read)
            os.close(write)
            try:
                running = Forks(asking, answering, Path(place) / "output")
            except EOFError:
                log.seek(0)
                raise EOFError(log.read().decode(errors="replace")[-2000:]) from None
            try:
                yield running
            finally:
                running.close()


@pytest.hookimpl(tryfirst=True)
def pytest_runtestloop(session: pytest.Session) -> bool | None:
    """Run requested tests until the pipe is closed; without pipes, let pytest run as usual."""
    channels = os.environ.pop(CHANNELS, "")
    if not channels:
        return None
    read, write = map(int, channels.split(","))
    # tests that start pytest are slow, so they come last: a file's last tests may be skipped
    quick_first = sorted(session.items, key=lambda item: "pytester" in getattr(item, "fixturenames", ()))
    items = {item.nodeid: item for item in quick_first}
    known = functions()
    own = marks() if os.environ.get("REACH_MARKS") else None
    imported = own.taken() if own else []
    gc.collect()
    gc.freeze()
    with os.fdopen(read) as requests, os.fdopen(write, "w") as answers:
        print(json.dumps([*items]), file=answers, flush=True)
        for line in requests:
            request = json.loads(line)
            Path(request["output"]).write_text("")
            child = os.fork()
            if not child:
                _run(session, items, known, own, imported, request)
            print(ended(child, request["limit"]), file=answers, flush=True)
    return True


def functions() -> dict[str, list[FunctionType]]:
    """Return this process's Python functions by file."""
    found: dict[str, list[FunctionType]] = {}
    for one in gc.get_objects():
        if type(one) is FunctionType:
            found.setdefault(one.__code__.co_filename, []).append(one)
    return found


def changed(known: Sequence[FunctionType], text: bytes, path: str, line: int) -> int:
    """Replace the code of a file's functions by that of its new text; return how many changed.

    `line` is the first line that differs; functions below it may have moved, but not changed. Raise ValueError if a
    function no longer uses the same variables of its enclosing functions.
    """
    codes: dict[tuple[str, int], list[CodeType]] = {}
    waiting = [compile(text, path, "exec", dont_inherit=True)]
    while waiting:
        code = waiting.pop()
        waiting += [one for one in code.co_consts if isinstance(one, CodeType)]
        codes.setdefault(_place(code), []).append(code)
    number = 0
    for function in known:
        new = codes.get(_place(function.__code__), [])
        if function.__code__.co_firstlineno <= line and len(new) == 1 and new[0] != function.__code__:
            function.__code__ = new[0]
            number += 1
    return number


def _place(code: CodeType) -> tuple[str, int]:
    return getattr(code, "co_qualname", code.co_name), code.co_firstlineno


def _run(
    session: pytest.Session,
    items: Mapping[str, pytest.Item],
    known: Mapping[str, Sequence[FunctionType]],
    own: Marks | None,
    imported: Sequence[int],
    request: Mapping[str, Any],
) -> None:
    """Run the tests of a request in this process (a fork), then end the process."""
    status = 1
    try:
        os.setsid()
        if not _inserted(known, request):
            status = UNCHANGED
            return
        measured = own if request["slowest"] else None
        chosen = [items[name] for name in request["tests"]]
        with Path(request["output"]).open("a", buffering=1) as output:
            if measured and not chosen:
                print(_told("", True, 0.0, measured.lines(imported)), file=output)
            status = _tested(session, chosen, output, measured, request["slowest"])
    finally:
        os._exit(status)


def _inserted(known: Mapping[str, Sequence[FunctionType]], request: Mapping[str, Any]) -> bool:
    """Put a request's fault, if any, into this process's functions; return whether this succeeds."""
    path = request["path"]
    if not path:
        return True
    with suppress(ValueError):
        return changed(known.get(path, ()), Path(path).read_bytes(), path, request["line"]) > 0
    return False


def _tested(
    session: pytest.Session,
    items: Sequence[pytest.Item],
    output: TextIO,
    measured: Marks | None,
    slowest: float,
) -> int:
    """Run the tests; return 1 at the first failure or, when measuring, once the file has taken too long."""
    failures: list[str] = []

    class Reports:
        def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
            if report.failed:
                failures.append(report.nodeid)

    session.config.pluginmanager.register(Reports())
    if measured:
        signal.signal(signal.SIGPROF, _too_slow)
    total = 0.0
    for item, following in zip(items, [*items[1:], None], strict=True):
        print(json.dumps({"test": item.nodeid, "passed": None}), file=output)
        before, failed = sum(os.times()[:4]), len(failures)
        if measured:
            measured.taken()
            signal.setitimer(signal.ITIMER_PROF, slowest)
        try:
            session.config.hook.pytest_runtest_protocol(item=item, nextitem=following)
        except TimeoutError:
            failures.append(item.nodeid)
        if measured:
            signal.setitimer(signal.ITIMER_PROF, 0)
        seconds = sum(os.times()[:4]) - before
        passed = len(failures) == failed
        lines = measured.lines(measured.taken()) if measured else {}
        print(_told(item.nodeid, passed, seconds, lines), file=output)
        if not passed and not measured:
            return 1
        total += seconds
        if measured and total > MOST_OF_FILE * slowest:
            return 1
    return 0


def _too_slow(_number: int, _frame: FrameType | None) -> None:
    raise TimeoutError("the test takes too much CPU time to be measured")


def _told(test: str, passed: bool, seconds: float, lines: Mapping[str, Sequence[int]]) -> str:
    """Return a test's result as a line of JSON for the fork's output."""
    return json.dumps({"test": test, "passed": passed, "seconds": seconds, "lines": [*lines.items()]})
