"""The lines that each test reaches, and faults that are put into the functions of a fork."""

from __future__ import annotations

import ast
import importlib
from collections.abc import Iterator
from pathlib import Path
from types import FunctionType, SimpleNamespace
from typing import Any

import pytest

BENCHMARKS = Path(__file__).parent.parent / "benchmarks"
MODULE = '''\
LIMIT = 3
def sign(x):
    """Return a word."""
    word = "zero"
    if x > 0:
        return "plus"
    elif x < 0:
        word = "minus"
    for _ in range(LIMIT):
        x += (
            1
        )
    try:
        pass
    except ValueError:
        raise
    match x:
        case 1 if word:
            word = "one"
    def inner():
        return word
    return inner
class C:
    """A class."""
    def method(self):
        return LIMIT
'''


@pytest.fixture
def modules(monkeypatch: pytest.MonkeyPatch) -> Any:
    monkeypatch.syspath_prepend(str(BENCHMARKS))
    names = ("reach_marks", "forked_tests", "sown_faults", "mutants")
    return SimpleNamespace(**{name: importlib.import_module(name) for name in names})


def reached(modules: Any, call: str) -> set[int]:
    """Return the lines of MODULE that a call reaches."""
    tree, found = modules.reach_marks.marked(ast.parse(MODULE), 100)
    memory = bytearray(200)
    space: dict[str, Any] = {modules.reach_marks.NAME: memory}
    exec(compile(tree, "module.py", "exec"), space)
    eval(call, space)
    taken = modules.reach_marks.Marks({}, memory).taken()
    assert not any(memory)
    return {line for mark in taken for line in found[mark]}


@pytest.mark.parametrize(
    ("call", "lines"),
    [
        ("C()", set()),
        ("C().method()", {26}),
        ("sign(2)", {4, 5, 6}),
        ("sign(-2)", {4, 5, 7, 8, 9, 10, 11, 12, 13, 14, 17, 18, 19, 22}),
        ("sign(0)", {4, 5, 7, 9, 10, 11, 12, 13, 14, 17, 18, 22}),
        ("sign(0)()", {4, 5, 7, 9, 10, 11, 12, 13, 14, 17, 18, 21, 22}),
    ],
)
def test_marks_show_which_lines_ran(modules: Any, call: str, lines: set[int]) -> None:
    assert reached(modules, call) == lines


def test_marked_functions_keep_their_docstrings_and_line_numbers(modules: Any) -> None:
    tree, _ = modules.reach_marks.marked(ast.parse(MODULE), 0)
    space: dict[str, Any] = {modules.reach_marks.NAME: bytearray(100)}
    exec(compile(tree, "module.py", "exec"), space)
    assert space["sign"].__doc__ == "Return a word."
    assert space["C"].__doc__ == "A class."
    plain: dict[str, Any] = {}
    exec(compile(MODULE, "module.py", "exec"), plain)
    for name in ("sign", "C"):
        own, other = (getattr(one[name], "method", one[name]) for one in (space, plain))
        assert {line for *_, line in own.__code__.co_lines()} == {
            line for *_, line in other.__code__.co_lines()
        }


def test_each_faulty_line_has_a_mark(modules: Any) -> None:
    """Otherwise a fault counts as unreached although tests run it."""
    for file in sorted((BENCHMARKS.parent / "pytest_tarl" / "bags").glob("*.py")):
        _, found = modules.reach_marks.marked(ast.parse(file.read_bytes()), 0)
        lines = {line for numbers in found.values() for line in numbers}
        lost = [one for one in modules.sown_faults.faults(file, file.name) if not lines & {*one.lines}]
        assert not lost


def functions(text: str) -> dict[str, Any]:
    space: dict[str, Any] = {}
    exec(compile(text, "half.py", "exec", dont_inherit=True), space)
    return space


HALF = """\
def wrap(f):
    return lambda x: f(x) / 2
@wrap
def half(x):
    return x
class C:
    def half(self, x):
        return x / 2
def other():
    return [x / 2 for x in (2, 4)]
"""


@pytest.mark.parametrize(
    ("was", "now", "calls"),
    [
        ("f(x) / 2", "f(x) * 2", ["half(4)"]),
        ("    return x\n", "    return -x\n", ["half(4)"]),
        ("        return x / 2", "        return x * 2", ["C().half(4)"]),
        ("[x / 2", "[x * 2", ["other()"]),
    ],
)
def test_fault_is_put_into_functions(modules: Any, was: str, now: str, calls: list[str]) -> None:
    every = ["half(4)", "C().half(4)", "other()"]
    space, text = functions(HALF), HALF.replace(was, now)
    known = modules.forked_tests.functions()["half.py"]
    known = [one for one in known if one.__globals__ is space]
    assert modules.forked_tests.changed(known, text.encode(), "half.py", line_of(was)) >= 1
    fresh = functions(text)
    assert [eval(one, space) for one in every] == [eval(one, fresh) for one in every]
    before = functions(HALF)
    assert [one for one in every if eval(one, space) != eval(one, before)] == calls


def line_of(was: str) -> int:
    return HALF[: HALF.index(was)].count("\n") + 1


def test_functions_that_only_moved_are_left_alone(modules: Any) -> None:
    space = functions(HALF)
    known: list[FunctionType] = [one for one in space.values() if isinstance(one, FunctionType)]
    text = HALF.replace("    return lambda", "    pass\n\n    return lambda")
    before = space["other"].__code__
    modules.forked_tests.changed(known, text.encode(), "half.py", 2)
    assert space["other"].__code__ is before


def test_fault_in_closure_variables_is_refused(modules: Any) -> None:
    text = "def outer(a):\n    def inner():\n        print(a)\n        return 1\n    return inner\n"
    inner = functions(text)["outer"](1)
    with pytest.raises(ValueError, match="free vars"):
        modules.forked_tests.changed([inner], text.replace("print(a)", "pass").encode(), "half.py", 3)


def test_a_file_without_changed_functions_is_reported(modules: Any) -> None:
    known = [one for one in functions(HALF).values() if isinstance(one, FunctionType)]
    assert modules.forked_tests.changed(known, HALF.encode(), "half.py", 2) == 0


TESTS = """\
from pathlib import Path
import subprocess, sys
from pack import half
def test_value(): assert half.half(4) == 2
def test_weak(): half.half(4)
def test_ends(): assert half.down(3) == 0
def test_always(): assert False
def test_other_process():
    told = subprocess.run([sys.executable, "-c", "from pack.half import low; print(low())"], stdout=-1)
    assert told.stdout == b"1\\n"
def test_constant(): assert half.FIVE == 5
"""
CODE = """\
def half(x):
    return x / 2
def down(x):
    while x > 0:
        x -= 1
    return x
def low():
    return min(1, 2)
def five():
    return 2 + 3
FIVE = five()
def unused():
    return 1 - 1
"""


@pytest.fixture(scope="module")
def project(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("project")
    (folder / "pack").mkdir()
    (folder / "pack" / "__init__.py").write_text("")
    (folder / "pack" / "half.py").write_text(CODE)
    (folder / "test_half.py").write_text(TESTS)
    return folder


@pytest.fixture(scope="module")
def patched() -> Iterator[pytest.MonkeyPatch]:
    with pytest.MonkeyPatch.context() as found:
        found.syspath_prepend(str(BENCHMARKS))
        yield found


@pytest.fixture(scope="module")
def measured(project: Path, patched: pytest.MonkeyPatch) -> Any:
    return importlib.import_module("mutants").measured_in_forks(project, "pack", ["test_half.py"])


@pytest.fixture(scope="module")
def forked(project: Path, patched: pytest.MonkeyPatch) -> Iterator[Any]:
    mutants = importlib.import_module("mutants")
    with mutants.forks(project, mutants.environment(project), ["test_half.py"]) as found:
        yield found


def test_the_measured_tests_reach_lines_also_in_their_processes(measured: Any, modules: Any) -> None:
    names = {number: measured.at("pack/half.py", [number]) for number in (2, 4, 5, 6, 8, 10, 13)}
    short = {number: [one.partition("::")[2] or one for one in tests] for number, tests in names.items()}
    assert short == {
        2: ["test_value", "test_weak"],
        4: ["test_ends"],
        5: ["test_ends"],
        6: ["test_ends"],
        8: ["test_other_process"],
        10: [modules.forked_tests.IMPORTED, "test_other_process"],
        13: [],
    }
    assert "test_half.py::test_always" not in measured.seconds
    assert measured.seconds["test_half.py::test_other_process"] > 0


@pytest.mark.parametrize(
    ("line", "was", "tests", "word"),
    [
        (2, "/", ["test_value"], "caught"),
        (2, "/", ["test_weak", "test_value"], "caught"),
        (2, "/", ["test_weak"], "survived"),
        (2, "/", ["test_always"], "unclear"),
        (5, "-", ["test_ends"], "timeout"),
        (8, "min", ["test_other_process"], "caught"),
        (13, "-", [], "unreached"),
    ],
)
def test_only_a_passing_test_can_catch_a_fault(
    modules: Any, project: Path, forked: Any, line: int, was: str, tests: list[str], word: str
) -> None:
    file = project / "pack" / "half.py"
    found = modules.sown_faults.faults(file, "pack/half.py")
    fault = next(one for one in found if (one.line, one.was) == (line, was))
    names = [f"test_half.py::{one}" for one in tests]
    outcome = modules.mutants.tried_in_fork(
        fault, project, names, dict.fromkeys(names, 0.0), forked, 1.0 if word == "timeout" else 60.0
    )
    assert outcome.word == word
    assert outcome.failed == (names[-1] if word in ("caught", "timeout", "unclear") else "")
    assert file.read_text() == CODE


def test_an_unchanged_file_needs_a_fresh_process(modules: Any, project: Path, forked: Any) -> None:
    ran = forked(["test_half.py::test_weak"], 60.0, str(project / "pack" / "half.py"), 2)
    assert ran.status == str(modules.forked_tests.UNCHANGED)


def test_the_reason_is_given_if_pytest_does_not_start(modules: Any, tmp_path: Path) -> None:
    environment = modules.mutants.environment(tmp_path)
    with (
        pytest.raises(EOFError, match=r"file or directory not found: nowhere\.py"),
        modules.forked_tests.forks(tmp_path, environment, ["nowhere.py"]),
    ):
        pass


@pytest.mark.parametrize(
    ("words", "text"),
    [
        (["caught"] * 8 + ["timeout", "unclear"], "90 % (55 % to 100 %)"),
        (["caught"] * 10, "100 % (69 % to 100 %)"),
        (["survived"] * 4 + ["unreached"] * 6, "0 % (0 % to 31 %)"),
        (["caught"] * 11 + ["survived"] * 4, "73 % (45 % to 92 %)"),
    ],
)
def test_a_share_has_its_exact_interval(modules: Any, words: list[str], text: str) -> None:
    assert modules.mutants.share([SimpleNamespace(word=word) for word in words]) == text
