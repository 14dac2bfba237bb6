"""Which tests reach each line, read from coverage's contexts."""

from __future__ import annotations

import json
import sqlite3
from bisect import bisect_right
from collections.abc import Iterable
from dataclasses import dataclass, field
from itertools import accumulate
from pathlib import Path


@dataclass
class Reached:
    """The tests of each line, with one bit per test, and the CPU seconds of each passing test."""

    tests: list[str] = field(default_factory=list)
    lines: dict[tuple[str, int], int] = field(default_factory=dict)
    seconds: dict[str, float] = field(default_factory=dict)
    everywhere: bool = False  # whether every test counts as reaching every line

    @classmethod
    def of_files(cls, files: Iterable[str]) -> Reached:
        """Return test files as tests that are assumed to reach every line and to take no time."""
        tests = sorted(files)
        return cls(tests, seconds=dict.fromkeys(tests, 0.0), everywhere=True)

    def at(self, path: str, lines: Iterable[int]) -> list[str]:
        """Return the tests that reach one of the lines of a file."""
        if self.everywhere:
            return self.tests
        bits = 0
        for line in lines:
            bits |= self.lines.get((path, line), 0)
        return sorted({name for number, name in enumerate(self.tests) if bits >> number & 1})

    def has(self, test: str, path: str, lines: Iterable[int]) -> bool:
        """Return whether a test reaches one of the lines of a file."""
        return test in self.at(path, lines)

    def within(self, budget: float, tests: Iterable[str], module: str) -> list[str]:
        """Return passing tests that together take at most `budget` CPU seconds, but at least one test.

        Tests in the file named after the module come first, then the others, each group from fast to slow.
        """
        own = f"test_{Path(module).stem}.py"

        def order(test: str) -> tuple[bool, float, str]:
            return Path(test.partition("::")[0]).name != own, self.seconds[test], test

        passing = sorted((test for test in tests if test in self.seconds), key=order)
        ends = list(accumulate(self.seconds[test] for test in passing))
        return passing[: max(1, bisect_right(ends, budget))]

    def add(self, other: Reached) -> None:
        """Add the lines that other tests reach."""
        shift = len(self.tests)
        self.tests += other.tests
        for place, bits in other.lines.items():
            self.lines[place] = self.lines.get(place, 0) | bits << shift
        self.seconds |= other.seconds

    def write(self, file: Path) -> None:
        """Write everything to a file for `read`."""
        lines = [[*place, f"{bits:x}"] for place, bits in self.lines.items()]
        file.write_text(json.dumps({"tests": self.tests, "lines": lines, "seconds": self.seconds}))


def read(file: Path) -> Reached:
    """Read a file written by `write`."""
    data = json.loads(file.read_text())
    lines = {(path, line): int(bits, 16) for path, line, bits in data["lines"]}
    return Reached(data["tests"], lines, data["seconds"])


def from_coverage(data: Path, root: Path, seconds: dict[str, float]) -> Reached:
    """Read the tests of each line from coverage's database, which stores lines as bits of a blob."""
    found = Reached(seconds=seconds)
    numbers: dict[str, int] = {}
    query = (
        "select file.path, context.context, numbits from line_bits "
        "join file on file.id = file_id join context on context.id = context_id"
    )
    with sqlite3.connect(data) as base:
        for path, context, blob in base.execute(query):
            test = context.rpartition(" (")[0] if context.endswith(")") and " (" in context else context
            if not test:
                continue
            bit = 1 << numbers.setdefault(test, len(numbers))
            name = Path(path).relative_to(root).as_posix()
            for line in _lines(blob):
                found.lines[name, line] = found.lines.get((name, line), 0) | bit
    found.tests = list(numbers)
    return found


def _lines(blob: bytes) -> Iterable[int]:
    return (byte * 8 + bit for byte, value in enumerate(blob) for bit in range(8) if value & (1 << bit))
