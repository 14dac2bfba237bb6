from __future__ import annotations

import ast
import contextlib
import doctest
import importlib.util
import inspect
import linecache
import pickle
import sys
import traceback
import types
from collections.abc import Iterator
from importlib.machinery import ExtensionFileLoader, ModuleSpec
from pathlib import Path
from typing import Any

import pytest

from pytest_tarl.instrumentation.importhook import AlreadyImportedWarning, NodeImports
from pytest_tarl.instrumentation.recorder import Recorder

NODE = '''\
"""A node."""
import pickle

from gains import gain, seen


class Message:
    value = 1.0


def callback(data):
    vel = gain(data) * 2.0
    return vel


if __name__ == "__main__":
    again = pickle.loads(pickle.dumps(Message()))
    out = callback(1.5)
'''
GAINS = "seen = []\n\n\ndef gain(x):\n    seen.append(x)\n    return 10.0 * len(seen)\n"
SITES = {(12, 5): 0, (13, 5): 1}
IN_GAINS = {(6, 5): 2}


@pytest.fixture
def project(tmp_path: Path) -> Path:
    (tmp_path / "node.py").write_text(NODE)
    (tmp_path / "gains.py").write_text(GAINS)
    return tmp_path


@pytest.fixture(autouse=True)
def _bytecode_is_written(monkeypatch):
    monkeypatch.setattr("sys.dont_write_bytecode", False)


def imports(project: Path, recorder: Recorder, **options: Any) -> NodeImports:
    plan = {project / "node.py": SITES, project / "gains.py": IN_GAINS}
    return NodeImports(project, options.pop("plan", plan), recorder.hook, bind=recorder.bind, **options)


def recorded(recorder: Recorder) -> list[tuple[int, float]]:
    trace = recorder.finish()
    return list(zip(trace.site.tolist(), trace.flow.tolist(), strict=True))


def test_script_and_its_imports_are_recorded(project):
    recorder = Recorder()
    with imports(project, recorder) as node:
        module = node.run_script(project / "node.py")
    assert module.out == 20.0
    assert module.again.value == 1.0
    assert recorded(recorder) == [(2, 10.0), (0, 20.0), (1, 20.0)]


def test_the_hook_works_without_a_bound_recorder(project):
    events: list[Any] = []
    plan = {project / "node.py": SITES}

    def hook(number, value):
        events.append((number, value))
        return value

    with NodeImports(project, plan, hook) as node:
        node.run_script(project / "node.py")
    assert events == [(0, 20.0), (1, 20.0)]


def test_every_episode_has_new_modules_and_restores_the_interpreter(project):
    main, path, finders = sys.modules["__main__"], list(sys.path), list(sys.meta_path)
    known = set(sys.modules)
    for _ in range(2):
        with imports(project, Recorder()) as node:
            module = node.run_script(project / "node.py")
            assert sys.modules["__main__"] is module
            assert sys.modules["gains"].seen == [1.5]
    assert sys.modules["__main__"] is main
    assert (sys.path, sys.meta_path) == (path, finders)
    assert set(sys.modules) - known <= {"pickle"}


def test_helpers_without_sites_are_reloaded(project, monkeypatch):
    (project / "world.py").write_text("tide = []\n")
    monkeypatch.syspath_prepend(project)
    with imports(project, Recorder(), plan={}) as node:
        world = __import__("world")
        node.run_script(project / "node.py")
        assert "gains" in sys.modules
    try:
        assert sys.modules["world"] is world
        assert "gains" not in sys.modules
    finally:
        del sys.modules["world"]


def test_a_test_can_import_its_node_inside_the_episode(project, monkeypatch):
    monkeypatch.syspath_prepend(project)
    recorder = Recorder()
    with imports(project, recorder):
        node = __import__("node")
        assert node.__name__ == node.__spec__.name == "node"
        assert node.__file__ == node.__spec__.origin == str(project / "node.py")
        assert inspect.getsource(node.callback) == "".join(NODE.splitlines(keepends=True)[10:13])
        assert node.__loader__.get_source("node") == NODE
        node.callback(0.0)
    assert "node" not in sys.modules
    assert recorded(recorder) == [(2, 10.0), (0, 20.0), (1, 20.0)]


LIBRARY = '''\
"""Numbers of a robot.

>>> half(3.0)
1.5
"""
import enum
from dataclasses import dataclass
from typing import NamedTuple


def half(x):
    """
    >>> half("x")
    Traceback (most recent call last):
    TypeError: unsupported operand type(s) for /: 'str' and 'int'
    """
    y = x / 2
    return y


@dataclass
class Pose:
    x: float

    class Part:
        def __init__(self, n):
            self.n = half(n)

    def moved(self):
        """
        >>> Pose(1.0).moved()
        Pose(x=2.0)
        """
        return Pose(self.x + 1.0)


class Mode(enum.Enum):
    AUTO = 1


class Pair(NamedTuple):
    a: float
    b: float = 2.0
'''


@contextlib.contextmanager
def library(project: Path, recorder: Recorder) -> Iterator[Any]:
    """Import a module with every statement recorded."""
    file = project / "numbers_of_a_robot.py"
    file.write_text(LIBRARY)
    every = {
        (node.lineno, node.col_offset + 1): n
        for n, node in enumerate(ast.walk(ast.parse(LIBRARY)))
        if isinstance(node, ast.stmt)
    }
    with imports(project, recorder, plan={file: every}):
        yield importlib.import_module(file.stem)


def test_functions_classes_and_instances_can_be_pickled(project, monkeypatch):
    monkeypatch.syspath_prepend(project)
    recorder = Recorder()
    with library(project, recorder) as module:
        objects = [
            module.half,
            module.Pose,
            module.Pose.Part,
            module.Pose.moved,
            module.Mode.AUTO,
            module.Mode,
        ]
        for protocol in range(2, pickle.HIGHEST_PROTOCOL + 1):
            stored = pickle.dumps(objects, protocol)
            assert b"tarl" not in stored
            assert all(a is b for a, b in zip(pickle.loads(stored), objects, strict=True))
            values = [module.Pose(1.5), module.Pair(1.0)]
            assert pickle.loads(pickle.dumps(values, protocol)) == values
            assert pickle.loads(pickle.dumps(module.Pose.Part(3.0), protocol)).n == 1.5
        in_recorded = pickle.dumps([module.Pose(1.5), module.Pair(1.0), module.half])
    assert len(recorder.finish().site) > 10
    plain = importlib.import_module("numbers_of_a_robot")  # the plain program loads the stored objects
    try:
        assert pickle.loads(in_recorded) == [plain.Pose(1.5), plain.Pair(1.0), plain.half]
    finally:
        del sys.modules["numbers_of_a_robot"]


def test_the_doctests_of_a_recorded_module_pass(project, monkeypatch):
    monkeypatch.syspath_prepend(project)
    with library(project, Recorder()) as module:
        assert doctest.testmod(module) == (0, 3)


def test_modules_in_packages_are_instrumented_and_removed(project, monkeypatch):
    package = project / "robot"
    package.mkdir()
    (package / "__init__.py").write_text("name = 'r2'\n")
    (package / "drive.py").write_text("from . import name\nspeed = len(name) * 1.0\n")
    monkeypatch.syspath_prepend(project)
    import robot

    recorder = Recorder()
    try:
        with imports(project, recorder, plan={package / "drive.py": {(2, 1): 0}}):
            from robot import drive

            assert robot.drive is drive
        assert not hasattr(robot, "drive")
        assert "robot.drive" not in sys.modules
        assert sys.modules["robot"] is robot
    finally:
        del sys.modules["robot"]
    assert recorded(recorder) == [(0, 2.0)]


def test_overlay_replaces_text_and_keeps_lines(project):
    edited = NODE.replace("import pickle\n", "import pickle\nimport math\n").replace(
        "* 2.0", "* (5.0 if data else 2.0)"
    )
    recorder = Recorder()
    file = project / "node.py"
    with imports(project, recorder, overlay={file: edited}) as node:
        module = node.run_script(file)
        assert module.out == 50.0
        assert linecache.getline(str(file), 13) == "    vel = gain(data) * (5.0 if data else 2.0)\n"
        assert inspect.getsource(module.callback).endswith("return vel\n")
    assert recorded(recorder) == [(2, 10.0), (0, 50.0), (1, 50.0)]
    assert linecache.getline(str(file), 13) == "    return vel\n"
    assert file.read_text() == NODE
    assert not [entry for entry in (project / ".tarl" / "cache").iterdir() if entry.name.startswith("node-")]


def test_the_node_imports_the_overlay_of_a_module(project):
    recorder = Recorder()
    with imports(project, recorder, overlay={project / "gains.py": GAINS.replace("10.0", "7.0")}) as node:
        assert node.run_script(project / "node.py").out == 14.0
        assert "7.0" in sys.modules["gains"].__loader__.get_source("gains")


def test_errors_point_at_the_running_text(project):
    edited = NODE.replace("vel = gain(data) * 2.0", "vel = gain(data) / (data - 1.5)")
    with imports(project, Recorder(), overlay={project / "node.py": edited}) as node:
        with pytest.raises(ZeroDivisionError) as caught:
            node.run_script(project / "node.py")
        last = traceback.extract_tb(caught.value.__traceback__)[-1]
    assert (last.lineno, last.line) == (12, "vel = gain(data) / (data - 1.5)")


def test_syntax_error_is_raised_as_by_import(project):
    (project / "node.py").write_text("x = (\n")
    with imports(project, Recorder()) as node, pytest.raises(SyntaxError) as caught:
        node.run_script(project / "node.py")
    assert caught.value.filename == str(project / "node.py")


def test_compiler_warnings_are_suppressed(project):
    (project / "node.py").write_text("x = 1 is 1\n")
    with imports(project, Recorder()) as node:
        assert node.run_script(project / "node.py").x


def test_early_import_by_the_test_is_named_in_a_warning(project, monkeypatch):
    monkeypatch.syspath_prepend(project)
    gains = __import__("gains")
    try:
        with (
            pytest.warns(
                AlreadyImportedWarning, match=r"gains\.py was imported \(as gains\) before the episode"
            ),
            imports(project, Recorder()) as node,
        ):
            node.run_script(project / "node.py")
        assert sys.modules["gains"] is gains
    finally:
        del sys.modules["gains"]


def test_imported_script_that_runs_gives_no_warning(project, monkeypatch):
    monkeypatch.syspath_prepend(project)
    node_module = __import__("node")
    plan = {project / "node.py": SITES}
    try:
        with imports(project, Recorder(), plan=plan) as node:
            node.run_script(project / "node.py")
        assert sys.modules["node"] is node_module
    finally:
        del sys.modules["node"], sys.modules["gains"]


def test_columns_count_characters_in_any_encoding(project):
    text = "# -*- coding: latin-1 -*-\nü = 'é'; größe = 2.0; x = größe * 2\n"
    (project / "node.py").write_bytes(text.encode("latin-1"))
    recorder = Recorder()
    plan = {project / "node.py": {(2, 10): 0, (2, 23): 1}}
    with imports(project, recorder, plan=plan) as node:
        node.run_script(project / "node.py")
        assert node.unrecorded == {}
    assert recorded(recorder) == [(0, 2.0), (1, 4.0)]


def test_site_positions_without_a_statement_are_reported(project):
    plan = {project / "node.py": {(12, 5): 0, (99, 1): 1}}
    for _ in range(2):
        with imports(project, Recorder(), plan=plan) as node:
            node.run_script(project / "node.py")
            assert node.unrecorded == {project / "node.py": ((99, 1),)}


def test_code_is_cached_until_text_or_sites_change(project):
    cache = project / ".tarl" / "cache"

    def run(plan):
        recorder = Recorder()
        with imports(project, recorder, plan=plan) as node:
            node.run_script(project / "node.py")
        return recorded(recorder)

    file = project / "node.py"
    assert run({file: SITES}) == run({file: SITES}) == [(0, 20.0), (1, 20.0)]
    assert len(list(cache.iterdir())) == 1
    assert run({file: {(12, 5): 7}}) == [(7, 20.0)]
    file.write_text(NODE.replace("* 2.0", "* 3.0"))
    assert run({file: SITES}) == [(0, 30.0), (1, 30.0)]
    assert len(list(cache.iterdir())) == 3


def test_a_script_without_a_plan_runs_unchanged(project):
    recorder = Recorder()
    with imports(project, recorder, plan={}) as node:
        module = node.run_script(project / "node.py")
    assert module.out == 20.0
    assert not [name for name in vars(module) if "tarl" in name]
    assert recorded(recorder) == []


def test_the_import_of_each_module_is_searched_once(project, monkeypatch):
    asked: list[str] = []

    class Listener:
        @staticmethod
        def find_spec(fullname, path=None, target=None):
            asked.append(fullname)

    with imports(project, Recorder()) as node:
        monkeypatch.setattr(sys, "meta_path", [*sys.meta_path[:1], Listener, *sys.meta_path[1:]])
        node.run_script(project / "node.py")
        monkeypatch.undo()
    assert asked.count("gains") == 1


@pytest.fixture
def package(project: Path) -> Path:
    """`robot.arm.driver`, which imports from its own and the parent package."""
    (project / "src" / "robot" / "arm").mkdir(parents=True)
    (project / "src" / "robot" / "__init__.py").write_text("")
    (project / "src" / "robot" / "arm" / "__init__.py").write_text("")
    (project / "src" / "robot" / "limits.py").write_text(
        "seen = []\n\n\ndef bound(x):\n    return min(x, 1.0)\n"
    )
    driver = project / "src" / "robot" / "arm" / "driver.py"
    driver.write_text(
        "from ..limits import bound, seen\nfrom robot import limits\n\n\n"
        "def main():\n    seen.append(bound(3.0))\n    return len(seen) - 1\n\n\n"
        "if __name__ == '__main__':\n    main()\n"
    )
    return driver


LIMIT = {(5, 5): 0}


def test_a_script_in_a_package_supports_relative_imports(project, package):
    plan = {package.parent.parent / "limits.py": LIMIT}
    for _ in range(2):
        recorder = Recorder()
        with imports(project, recorder, plan=plan) as node:
            module = node.run_script(package)
        assert (module.__package__, module.seen) == ("robot.arm", [1.0])
        assert module.limits.seen is module.seen
        assert recorded(recorder) == [(0, 1.0)]
    assert not [name for name in sys.modules if name.startswith("robot")]


def test_a_module_may_have_the_name_of_its_package(project: Path) -> None:
    package = project / "viewer"
    package.mkdir()
    (package / "__init__.py").write_text("from .viewer import main\n")
    (package / "viewer.py").write_text("from . import size\ndef main():\n    return size.SIZE\n")
    (package / "size.py").write_text("SIZE = 3\n")
    (package / "__main__.py").write_text("from . import main\nfound = main()\n")
    for _ in range(2):
        with imports(project, Recorder(), plan={}) as node:
            assert node.run_script(package / "__main__.py").found == 3


def test_entry_point_runs_under_its_own_name(project, package):
    plan = {package.parent.parent / "limits.py": LIMIT, package: {(7, 5): 1}}
    for _ in range(2):
        recorder = Recorder()
        with imports(project, recorder, plan=plan) as node:
            node.run_entry(package, "main")
            assert sys.modules["robot.arm.driver"].seen == [1.0]
        assert recorded(recorder) == [(0, 1.0), (1, 0.0)]
    assert not [name for name in sys.modules if name.startswith("robot")]


def test_entry_point_result_is_the_exit_status(project):
    (project / "fails.py").write_text(
        "class App:\n    @staticmethod\n    def run():\n        return 'no motor'\n"
    )
    with imports(project, Recorder(), plan={}) as node, pytest.raises(SystemExit, match="no motor"):
        node.run_entry(project / "fails.py", "App.run")
    with imports(project, Recorder(), plan={}) as node, pytest.raises(AttributeError, match="main"):
        node.run_entry(project / "fails.py", "main")


def test_modules_without_source_in_the_project_stay_imported(project: Path) -> None:
    node = imports(project, Recorder())
    outside = types.ModuleType("made_by_a_test")
    folder = types.ModuleType("namespace_package")
    folder.__spec__ = ModuleSpec("namespace_package", None, is_package=True)
    compiled = types.ModuleType("compiled")
    compiled.__spec__ = ModuleSpec(
        "compiled", ExtensionFileLoader("compiled", "x.so"), origin=str(project / "x.so")
    )
    own = types.ModuleType("gains")
    own.__spec__ = importlib.util.spec_from_file_location("gains", project / "gains.py")
    assert [node._belongs(one) for one in (outside, folder, sys, compiled, own)] == [False] * 4 + [True]
