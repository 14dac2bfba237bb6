"""Compare the values that TARL finds in random Python programs with those that Python computes.

    python benchmarks/interpreted_programs.py [--count 2000] [--seed 0] [--show 3]

Each program uses the parts of Python with which launch files compute values: regular expressions, collections,
itertools, data classes, enumerations, classes with special methods, generators, `match` patterns, exceptions and paths.
All values of a program are constant, so TARL must know each result, and it must equal Python's. Only programs that this
script makes are executed.
"""

from __future__ import annotations

import argparse
import itertools
import random
import sys
import tempfile
from collections import Counter
from pathlib import Path
from typing import Any

from program_expressions import Expressions

from tarl_lint.workspace.python.interpreter import Interpreter

IMPORTS = """\
import collections, contextlib, copy, dataclasses, enum, functools, itertools, json, math, operator, os, re, string
import textwrap
from collections import ChainMap, Counter, OrderedDict, defaultdict, deque, namedtuple
from dataclasses import asdict, astuple, dataclass, field, replace
from enum import Enum, IntEnum, auto
from functools import partial, reduce
from pathlib import Path, PurePosixPath
from string import Template
from typing import NamedTuple
"""


class Programs(Expressions):
    """Writes random programs."""

    def program(self) -> str:
        """Return a program whose results are the elements of the list `r`."""
        kinds = (self.number, self.text, self.texts, self.numbers, self.table)
        results = []
        for _ in range(self.random.randint(3, 6)):
            before = len(self.definitions)
            value = self.random.choice(kinds)()
            results += [*self.definitions[before:], f"r.append({value})"]
        return "\n".join([IMPORTS, "r = []", *results]) + "\n"


def compared(text: str, folder: Path) -> tuple[int, list[str]]:
    """Return a program's number of results, and a line for each result on which TARL and Python differ.

    Raise SyntaxError, and any exception that the program raises.
    """
    real: dict[str, Any] = {"__name__": "__main__"}
    exec(compile(text, "program", "exec"), real)  # noqa: S102 - only programs of this script
    path = folder / "program.py"
    path.write_text(text, encoding="utf-8")
    interpreter = Interpreter(path, {})
    found = interpreter.run().get("r", [])
    wrong = [f"{problem.line}: {problem.reason}" for problem in interpreter.problems]
    results = list(real["r"])
    for index, right in enumerate(results):
        ours = found[index] if isinstance(found, list) and index < len(found) else "nothing"
        if type(ours) is not type(right) or ours != right or repr(ours) != repr(right):
            wrong.append(f"result {index}: {ours!r:.300} instead of {right!r:.300}")
    return len(results), wrong


def main() -> None:
    """Print the number of programs and results, and the differences."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--count", type=int, default=2_000)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--show", type=int, default=3)
    typed = parser.parse_args()
    total: Counter[str] = Counter()
    with tempfile.TemporaryDirectory() as folder:
        for number in itertools.count():
            if total["programs"] == typed.count:
                break
            text = Programs(random.Random(typed.seed * 1_000_000 + number)).program()
            try:
                results, wrong = compared(text, Path(folder))
            except (
                ArithmeticError,
                LookupError,
                TypeError,
                ValueError,
                AttributeError,
                SyntaxError,
            ) as error:
                total["raise an exception in Python"] += 1
                if typed.show < 0:
                    print(f"program {number}: {error!r}")
                continue
            total["programs"] += 1
            total["results"] += results
            total["right programs"] += not wrong
            total["wrong results"] += len(wrong)
            if wrong and total["shown"] < typed.show:
                total["shown"] += 1
                print(f"program {number}\n{text}\n" + "\n".join(wrong), file=sys.stderr)
    right, programs, wrong_results = total["right programs"], total["programs"], total["wrong results"]
    print(f"{right} of {programs} programs right, {wrong_results} of {total['results']} results wrong")
    print(f"{total['raise an exception in Python']} further programs raise an exception in Python")


if __name__ == "__main__":
    main()
