"""The program cannot observe the hook and the buffer of the instrumentation."""

from __future__ import annotations

import ast
import builtins
import pickle
import sys
import types
from pathlib import Path
from typing import Any

import pytest

from pytest_tarl.instrumentation.constants import bound
from pytest_tarl.instrumentation.entries import Entries, SharedEntries
from pytest_tarl.instrumentation.importhook import NodeImports
from pytest_tarl.instrumentation.instrument import compiled, instrument
from pytest_tarl.instrumentation.recorder import Recorder
from tests.plugin.instrumentation.programs import everywhere

MODULE = """
import enum
before = sorted(globals())
class Space(dict):
    def __missing__(self, name):
        asked.append(name)
        raise KeyError(name)
asked = []
class Meta(type):
    def __prepare__(*_): return Space()
class A(metaclass=Meta):
    x = 1.5
    def f(self, y):
        z = y * self.x
        return [z for _ in range(2)]
inside = sorted(vars(A))
def names():
    a = 1.0
    return sorted(globals()), sorted(locals()), names.__code__.co_names
seen = names()
total = A().f(2.0)
"""


def executed(tmp_path: Path, *, record: bool) -> types.ModuleType:
    file = tmp_path / "node.py"
    file.write_text(MODULE)
    sites = {(line, column + 1): n for (line, column), n in everywhere(ast.parse(MODULE)).items()}
    recorder = Recorder()
    plan = {file: sites} if record else {}
    with NodeImports(tmp_path, plan, recorder.hook, bind=recorder.bind) as imports:
        module = imports.run_script(file, "node")
        del sys.modules["node"]  # a later test may import another module of this name
    assert bool(recorder.finish().site.size) is record
    return module


def test_instrumented_namespaces_contain_only_names_of_the_program(tmp_path):
    plain, recorded = executed(tmp_path, record=False), executed(tmp_path, record=True)
    assert list(vars(recorded)) == list(vars(plain))
    for name in ("before", "asked", "inside", "total"):
        assert getattr(recorded, name) == getattr(plain, name)
    assert recorded.seen[:2] == plain.seen[:2]
    assert [name for name in recorded.seen[2] if name in plain.seen[2]] == list(plain.seen[2])
    assert not [name for name in dir(builtins) if "tarl" in name]


def function(source: str, recorder: Recorder) -> Any:
    tree = ast.parse(source)
    space: dict[str, Any] = {}
    exec(recorder.bind(compiled(instrument(tree, everywhere(tree), inline=True), "<program>")), space)
    return space["f"]


def test_instrumented_code_is_hashable_and_prints_no_events():
    source = "def f(x):\n    y = x * 2\n    return y\n"
    recorder = Recorder()
    one, same, other = (function(source, to) for to in (recorder, recorder, Recorder()))
    for _ in range(1000):
        one(1.0)
    assert one.__code__ == same.__code__
    assert one.__code__ != other.__code__
    assert len({one.__code__, same.__code__, other.__code__}) == 2
    assert "<events>" in str(one.__code__.co_consts)
    assert len(str(one.__code__.co_consts)) < 300


@pytest.mark.parametrize("threads", [False, True])
def test_a_pickled_function_computes_the_same_and_records_nothing(threads):
    cloudpickle = pytest.importorskip("cloudpickle")
    recorder = Recorder(threads=threads)
    f = function("def f(x):\n    y = x * 2.0\n    z = y + len('ab')\n    return z\n", recorder)
    elsewhere = pickle.loads(cloudpickle.dumps(f))
    assert elsewhere(3.0) == elsewhere(3) == 8.0
    assert recorder.finish().site.size == 0


@pytest.mark.parametrize("kind", [Entries, SharedEntries])
def test_recording_functions_are_compared_by_identity(kind):
    one, other = kind(list), kind(list)
    assert one == one
    assert one != other
    assert not one == other  # noqa: SIM201
    assert one != []
    assert len({one, other}) == 2


def test_constants_of_the_program_remain_the_same_objects():
    code = compile("x = (b'a', 'b', 1.5)\ndef f():\n    return 2j, b'c'\n", "<program>", "exec")
    assert bound(code, lambda _number, value: value) is code
