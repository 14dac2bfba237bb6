"""The faults of `make mutants`: each kind is located anywhere in a file, and only a failing test catches a fault."""

from __future__ import annotations

import ast
import importlib
import subprocess
from collections.abc import Iterator
from importlib.metadata import entry_points, packages_distributions
from pathlib import Path
from typing import Any

import pytest

BENCHMARKS = Path(__file__).parent.parent / "benchmarks"
PIECES = {  # code → the code with a fault
    "a < b < c": "a < b <= c",
    "-a": "a",
    "a % b": "a * b",
    "a ** b": "a * b",
    "min(a, b)": "max(a, b)",
    "any(c)": "all(c)",
    "a and b": "a or b",
    "not a": "a",
    "2": "3",
}
PLACES = (
    "    return {}\n",
    "    with f({}):\n        pass\n",
    "    match a:\n        case 1 if {}:\n            pass\n",
    "    match a:\n        case 1:\n            return {}\n",
    "    for x in {}:\n        pass\n",
    "    try:\n        pass\n    except E:\n        x = [{} for _ in y]\n",
    "    x += {}\n",
)


@pytest.fixture
def sown(monkeypatch: pytest.MonkeyPatch) -> Any:
    monkeypatch.syspath_prepend(str(BENCHMARKS))
    return importlib.import_module("sown_faults")


@pytest.fixture
def mutants(monkeypatch: pytest.MonkeyPatch, sown: Any) -> Any:
    return importlib.import_module("mutants")


def mutated(sown: Any, folder: Path, code: str) -> set[str]:
    file = folder / "module.py"
    file.write_text(code)
    return {ast.unparse(ast.parse(one.sown(code.encode()))) for one in sown.faults(file, "module.py")}


@pytest.mark.parametrize("place", PLACES)
@pytest.mark.parametrize(("piece", "faulty"), PIECES.items())
def test_an_injected_fault_is_located_anywhere_in_a_file(
    sown: Any, tmp_path: Path, place: str, piece: str, faulty: str
) -> None:
    text = "def f(a, b, c, x, y):\n" + place
    expected = ast.unparse(ast.parse(text.format(faulty)))
    assert expected in mutated(sown, tmp_path, text.format(piece))


@pytest.mark.parametrize("operator", ["+", "-", "*", "/", "//"])
def test_faults_are_injected_into_augmented_assignments(sown: Any, tmp_path: Path, operator: str) -> None:
    text = f"def f(x, y):\n    x {operator}= y\n    return x\n"
    assert mutated(sown, tmp_path, text)


def test_match_statement_has_the_lines_of_its_subject(sown: Any, tmp_path: Path) -> None:
    file = tmp_path / "module.py"
    file.write_text("def f(a):\n    match a + 1:\n        case 1:\n            return a < 2\n")
    assert {(one.kind.split()[0], one.lines) for one in sown.faults(file, "module.py")} == {
        ("arithmetic", (2,)),
        ("number", (2,)),
        ("comparison", (4,)),
        ("number", (4,)),
    }


INSIDE = """\
LIMIT = 3
if LIMIT > 2:
    @cache
    def f(a):
        text = '''
unindented'''
        def inner():
            nonlocal text
            text = f"{a + 1:{a - 2}d} {a < 2!r}" if a > 1 else f"{not a}"
        return inner
class C:
    x = 1
    @property
    async def g(self):
        async with self.a + 1 as b: await b.c(-1)
def h(): return 1
"""


def test_uncompilable_faults_are_left_out(sown: Any, tmp_path: Path) -> None:
    file, data = tmp_path / "module.py", INSIDE.encode()
    file.write_text(INSIDE)

    def compiles(text: bytes) -> bool:
        try:
            compile(text, "module.py", "exec", dont_inherit=True)
        except (SyntaxError, ValueError):
            return False
        return True

    every = {one for one in sown._Finder(data, "module.py").module(ast.parse(data)) if one.was != one.now}
    found = sown.faults(file, "module.py")
    assert found == sorted(one for one in every if compiles(one.sown(data)))
    assert {one.line for one in found} >= {9, 15, 16}


FAILS_ALWAYS = "def test_other(): assert False\n"
TESTS = {
    "from half import half\ndef test_half(): assert half(4) == 2\n": "caught",
    "from half import half\ndef test_half(): half(4)\n": "survived",
    FAILS_ALWAYS: "unclear",
    FAILS_ALWAYS.replace("assert False", "import os; os.abort()"): "unclear",
    "def another(): pass\n": "unclear",
    "import half\nassert half.half(4) == 2\ndef test_half(): pass\n": "caught",
}


@pytest.fixture
def runner(mutants: Any, tmp_path: Path) -> Iterator[Any]:
    with mutants.warm(tmp_path, mutants.environment(tmp_path), ()) as found:
        yield found


@pytest.mark.parametrize(("tests", "word"), TESTS.items(), ids=range(len(TESTS)))
def test_only_a_passing_test_catches_the_fault(
    mutants: Any, sown: Any, tmp_path: Path, runner: Any, tests: str, word: str
) -> None:
    file = tmp_path / "half.py"
    file.write_text("def half(x):\n    return x / 2\n")
    (tmp_path / "test_half.py").write_text(tests)
    (fault,) = (one for one in sown.faults(file, "half.py") if one.was == "/")
    name = "test_half.py::test_half" if "test_half()" in tests else "test_half.py"
    outcome = mutants.tried(fault, tmp_path, [name], {name: 1.0}, runner)
    assert outcome.word == word
    assert file.read_text() == "def half(x):\n    return x / 2\n"


def test_endless_tests_catch_no_faults(
    mutants: Any, sown: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def tested(_copy: Path, tests: list[str], limit: float, _runner: object) -> tuple[int, str]:
        if "*" in file.read_text() and fails:
            return 1, tests[0]
        raise subprocess.TimeoutExpired(tests, limit)

    monkeypatch.setattr(mutants, "tested", tested)
    file = tmp_path / "half.py"
    file.write_text("def half(x):\n    return x / 2\n")
    (fault,) = (one for one in sown.faults(file, "half.py") if one.was == "/")
    for fails in (True, False):  # noqa: B007 - read by `tested`
        word = mutants.tried(fault, tmp_path, ["test_half.py"], {"test_half.py": 1.0}, None).word
        assert word == "unclear"


def test_test_made_endless_by_a_fault_catches_it(
    mutants: Any, sown: Any, tmp_path: Path, runner: Any
) -> None:
    file = tmp_path / "half.py"
    file.write_text("def half(x):\n    while x > 1: x -= 1\n    return x\n")
    (tmp_path / "test_half.py").write_text("from half import half\ndef test_half(): half(4)\n")
    (fault,) = (one for one in sown.faults(file, "half.py") if one.was == "-=" or one.was == "-")
    name = "test_half.py::test_half"
    assert mutants.tried(fault, tmp_path, [name], {name: 0.1}, runner, 5.0).word == "timeout"


def test_the_tests_of_the_module_run_first(mutants: Any) -> None:
    own, other, slow = (
        "tests/test_half.py::test_a[x/y::z]",
        "tests/test_one.py::test_b",
        "tests/test_two.py::test_c",
    )
    reached = mutants.Reached(seconds={own: 5.0, other: 1.0, slow: 2.0})
    order = [own, other, slow]
    assert reached.within(100.0, reversed([*order, "tests/test_half.py::failed"]), "package/half.py") == order
    assert reached.within(6.0, order, "package/half.py") == order[:2]
    assert reached.within(0.1, order, "package/half.py") == order[:1]


def test_tests_with_their_own_ini_run_alone(mutants: Any, sown: Any, tmp_path: Path, runner: Any) -> None:
    file = tmp_path / "half.py"
    file.write_text("def half(x):\n    return x / 2\n")
    own = tmp_path / "tests" / "own"
    own.mkdir(parents=True)
    (own / "pytest.ini").write_text("[pytest]\naddopts = -p no:cacheprovider\n")
    (tmp_path / "pyproject.toml").write_text('[tool.pytest.ini_options]\naddopts = "--ignore=tests/own"\n')
    (own / "test_own.py").write_text("from half import half\ndef test_half(): assert half(4) == 2\n")
    (tmp_path / "tests" / "test_other.py").write_text("def test_other(): pass\n")
    names = ["tests/test_other.py::test_other", "tests/own/test_own.py::test_half"]
    assert importlib.import_module("tested_copy").with_own_settings(tmp_path, ["tests"]) == [
        "tests",
        "tests/own",
    ]
    (fault,) = (one for one in sown.faults(file, "half.py") if one.was == "/")
    assert mutants.tried(fault, tmp_path, names, dict.fromkeys(names, 1.0), runner).word == "caught"
    assert mutants.tried(fault, tmp_path, names[:1], dict.fromkeys(names, 1.0), runner).word == "survived"


def test_all_test_files_run_without_coverage(mutants: Any, tmp_path: Path, runner: Any) -> None:
    (tmp_path / "test_a.py").write_text("def test_a(): pass\n")
    (tmp_path / "test_half.py").write_text("def test_b(): assert 0\n")
    files = ["test_half.py", "test_a.py"]
    reached = mutants.Reached.of_files(files)
    assert reached.at("half.py", [1]) == sorted(files)
    assert reached.within(0.0, reached.at("half.py", [1]), "half.py") == ["test_half.py", "test_a.py"]
    assert mutants.tested(tmp_path, files, 60.0, runner) == (1, "test_half.py")


def test_the_warm_process_imports_no_plugin_of_pytest(mutants: Any) -> None:
    homes = packages_distributions()
    plugins = {one.dist.name for one in entry_points(group="pytest11") if one.dist is not None}
    names = {name.partition(".")[0] for name in importlib.import_module("warm_pytest").LIBRARIES}
    assert not plugins & {home for name in names for home in homes.get(name, ())}
