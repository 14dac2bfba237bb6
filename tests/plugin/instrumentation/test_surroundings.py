"""What surrounds a recorded program: replaced data files, threads, modules of its own, its search path, its events."""

from __future__ import annotations

import io
import linecache
import os
import pickle
import sys
import threading
from collections.abc import Callable
from pathlib import Path
from types import ModuleType, SimpleNamespace
from typing import Any

import numpy as np
import pytest

from pytest_tarl.instrumentation import launching
from pytest_tarl.instrumentation.datafiles import is_data, reading
from pytest_tarl.instrumentation.entries import Entries, SharedEntries, Unheard
from pytest_tarl.instrumentation.events import joined, paired, sizes
from pytest_tarl.instrumentation.launching import importable, on_search_path, restored_interpreter, shown
from pytest_tarl.instrumentation.magnitude import LIMIT
from pytest_tarl.instrumentation.nodecode import NodeCode, _offsets
from pytest_tarl.instrumentation.separate_modules import SeparateModules
from pytest_tarl.instrumentation.thread_starts import ThreadWatch

# data files


@pytest.mark.parametrize(
    ("name", "data"),
    [
        ("a.yaml", True),
        ("a.yml", True),
        ("a.json", True),
        ("a.toml", True),
        ("a.xml", True),
        ("a.launch", True),
        ("a.cfg", True),
        ("a.launch.py", True),
        ("a_launch.py", True),
        ("launch.py", False),
        ("a.py", False),
        ("yaml", False),
    ],
)
def test_data_files_are_recognised_by_their_file_name_extension(name: str, data: bool) -> None:
    assert is_data(Path("folder") / name) is data


@pytest.fixture
def file(tmp_path: Path) -> Path:
    path = tmp_path / "a.yaml"
    path.write_text("old\n", "utf-8")
    return path


READERS: dict[str, Callable[[Path], object]] = {
    "open": lambda path: open(path).read(),  # noqa: PTH123, SIM115
    "text": lambda path: path.read_text("utf-8"),
    "bytes": lambda path: path.read_bytes().decode(),
    "mode": lambda path: open(str(path), "rt", -1, "utf-8").read(),  # noqa: PTH123, SIM115, UP015
    "named": lambda path: open(os.fsencode(path), mode="rb").read().decode(),  # noqa: PTH123, SIM115
    "io": lambda path: io.open(path, encoding=None).read(),  # noqa: SIM115, UP020
}


@pytest.mark.filterwarnings("ignore::ResourceWarning")
@pytest.mark.parametrize("reader", READERS.values(), ids=READERS)
def test_reading_returns_the_replacement_and_the_file_is_unchanged(
    file: Path, reader: Callable[[Path], object]
) -> None:
    with reading({file: "new é\n"}):
        assert reader(file) == "new é\n"
        assert reader(file.parent / "x" / ".." / "a.yaml") == "new é\n"
    assert reader(file) == "old\n"
    assert file.read_text("utf-8") == "old\n"


def test_other_files_and_ways_of_opening_are_unchanged(file: Path) -> None:
    other = file.with_name("b.yaml")
    with reading({file: "new"}):
        other.write_text("other", "utf-8")
        assert other.read_text("utf-8") == "other"
        with file.open("a", encoding="utf-8") as opened:
            opened.write("more\n")
        with file.open("r+", encoding="utf-8") as opened:
            assert opened.read() == "old\nmore\n"
        number = os.open(file, os.O_RDONLY)
        with os.fdopen(number, encoding="utf-8") as opened:
            assert opened.read() == "old\nmore\n"


def test_replaced_texts_use_the_requested_encoding(file: Path) -> None:
    with reading({file: "é\r\nx"}):
        with file.open(encoding="latin-1") as opened:
            assert opened.read() == "Ã©\nx"
        with file.open(encoding="ascii", errors="replace", newline="") as opened:
            assert opened.read() == "��\r\nx"


def test_open_is_unchanged_without_replacements() -> None:
    usual = open
    with reading({}):
        assert open is usual
    with reading({Path("a.yaml"): ""}):
        assert open is not usual
    assert open is usual
    assert io.open is usual


# threads


def test_recorder_knows_each_new_thread_first() -> None:
    order: list[str] = []
    watch = ThreadWatch(lambda: order.append("heard"))
    watch.begin()
    try:
        for name in ("first", "second"):
            thread = threading.Thread(target=order.append, args=(name,))
            thread.start()
            thread.join()
    finally:
        watch.end()
    thread = threading.Thread(target=order.append, args=("after",))
    thread.start()
    thread.join()
    assert [one for one in order if one != "heard"] == ["first", "second", "after"]
    assert order.index("first") == order.count("heard") // 2
    assert order[-2:] == ["second", "after"]


def test_replaced_thread_starter_stays_in_place(monkeypatch: pytest.MonkeyPatch) -> None:
    import _thread

    usual: Any = _thread.start_new_thread
    watch = ThreadWatch(lambda: None)
    watch.begin()
    assert _thread.start_new_thread is not usual

    def other(*_: object) -> int:
        return 0

    monkeypatch.setattr(_thread, "start_new_thread", other)
    watch.end()
    assert _thread.start_new_thread is other
    _thread.start_new_thread = usual
    watch.begin()
    watch.end()
    assert _thread.start_new_thread is usual


# modules and paths of a program


@pytest.fixture
def _same_path(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "path", list(sys.path))


@pytest.mark.usefixtures("_same_path")
def test_each_program_has_its_own_modules_and_path(monkeypatch: pytest.MonkeyPatch) -> None:
    name, usual = "module_of_two_programs", list(sys.path)
    separate = SeparateModules(lambda: [one for one in sys.modules if one == name])
    made = {program: ModuleType(name) for program in ("a", "b")}
    for program, module in made.items():
        separate.enter(program)
        assert name not in sys.modules
        assert sys.path == usual
        sys.modules[name] = module
        sys.path.insert(0, program)
    for program in ("a", "a", "b", "a"):
        separate.enter(program)
        assert sys.modules[name] is made[program]
        assert sys.path == [program, *usual]
    separate.enter(None)
    assert name not in sys.modules
    assert sys.path == usual


def test_the_module_name_of_a_file_has_its_packages(tmp_path: Path) -> None:
    inner = tmp_path / "robot" / "drivers"
    inner.mkdir(parents=True)
    assert importable(inner / "driver.py") == (inner, "driver")
    (inner / "__init__.py").write_text("")
    assert importable(inner / "driver.py") == (tmp_path / "robot", "drivers.driver")
    (tmp_path / "robot" / "__init__.py").write_text("")
    assert importable(inner / "driver.py") == (tmp_path, "robot.drivers.driver")


@pytest.mark.parametrize(
    ("made", "root"),
    [
        (["a/.git/", "a/src/package.xml"], "a"),
        (["a/b/src/", "a/b/build/"], "a/b"),
        (["a/b/src/", "a/b/install/"], "a/b"),
        (["a/b/src/", "a/b/devel/"], "a/b"),
        (["a/b/src/", "a/b/build"], "a/b/src/p/inner"),
        (["a/setup.py", "a/b/src/p/package.xml"], "a"),
        (["a/b/pyproject.toml"], "a/b"),
        (["a/b/src/p/package.xml", "a/b/setup.py/"], "a/b/src/p"),
        (["a/b/src/p/inner/__init__.py"], "a/b/src/p"),
        (["a/b/src/p/.git", "a/b/build/"], "a/b/src/p"),
    ],
)
def test_node_project_is_its_repository_or_workspace(tmp_path: Path, made: list[str], root: str) -> None:
    folder = tmp_path / "a" / "b" / "src" / "p" / "inner"
    folder.mkdir(parents=True)
    for name in made:
        path = tmp_path / name
        (path if name.endswith("/") else path.parent).mkdir(parents=True, exist_ok=True)
        if not name.endswith("/"):
            path.write_text("")
    launching.workspace.cache_clear()
    assert launching.workspace(folder / "node.py") == (tmp_path / root).resolve()


@pytest.mark.usefixtures("_same_path")
def test_folders_are_added_once_to_the_search_path() -> None:
    before = list(sys.path)
    on_search_path(Path("/a"), Path("/b"))
    on_search_path(Path("/b"), Path("/c"))
    assert sys.path == ["/c", "/a", "/b", *before]


def test_the_search_path_and_the_main_module_are_restored() -> None:
    path, main = list(sys.path), sys.modules["__main__"]
    with pytest.raises(KeyError), restored_interpreter():  # noqa: PT012
        sys.path.insert(0, "/x")
        sys.modules["__main__"] = ModuleType("other")
        raise KeyError
    assert sys.path == path
    assert sys.modules["__main__"] is main


@pytest.mark.parametrize("known", [True, False])
def test_tracebacks_show_the_text_that_runs(file: Path, known: bool) -> None:
    if known:
        assert linecache.getline(str(file), 1) == "old\n"
    with shown(file, "one\ntwo"):
        assert [linecache.getline(str(file), line) for line in (1, 2, 3)] == ["one\n", "two", ""]
    assert (str(file) in linecache.cache) is known
    assert linecache.getline(str(file), 1) == "old\n"
    linecache.cache.pop(str(file))


# events


def test_events_record_nothing_in_another_process() -> None:
    first, second = Entries(list), Entries(list)
    first.append(1)
    assert first == first
    assert first != second
    assert not first != first  # noqa: SIM202
    assert (first != []) is True
    assert repr(first) == "<events>"
    assert len({first, second}) == 2
    copied = pickle.loads(pickle.dumps(first))
    assert isinstance(copied, Unheard)


def test_shared_events_go_to_the_running_thread() -> None:
    own: list[Any] = []
    shared = SharedEntries(lambda: own)
    shared.append(1)
    shared.extend([2, 3.0])
    assert own == [1, 2, 3.0]
    assert len(shared) == 0


@pytest.mark.parametrize(
    ("entries", "sites", "values", "starts"),
    [
        ([], [], [], []),
        ([1, 0.5, 2, 1.5], [1, 2], [0.5, 1.5], [0, 2]),
        ([1, 0.5, 2], [1], [0.5], [0]),
        ([1, 2, 1.5], [2], [1.5], [1]),
        ([1, 2, 1.5, 3], [2], [1.5], [1]),
        ([1, 2], [], [], []),
    ],
)
def test_incomplete_events_are_dropped(entries: list[Any], sites: Any, values: Any, starts: Any) -> None:
    found = paired(entries)
    assert [one.tolist() for one in found] == [sites, values, starts]
    assert [one.dtype for one in found] == [np.int32, np.float64, np.int64]


def test_pieces_of_events_are_joined_in_order() -> None:
    first, second = paired([1, 0.5]), paired([2, 1.5, 3, 2.5])
    assert [one.tolist() for one in joined([second, first])] == [[2, 3, 1], [1.5, 2.5, 0.5], [0, 2, 0]]
    assert joined([first]) is first


def test_flow_values_are_finite_and_limited() -> None:
    found = sizes(np.array([-2.0, 3.0, np.inf, -np.inf, np.nan, 2 * LIMIT, -2 * LIMIT, 0.0]))
    assert found.tolist() == [2.0, 3.0, 0.0, 0.0, 0.0, LIMIT, LIMIT, 0.0]


# code of a node


def test_character_columns_become_byte_offsets() -> None:
    text = "x = 1\né = y = 2\n"
    positions: Any = {(1, 1): 0, (2, 1): 1, (2, 5): 2, (9, 4): 3}
    assert _offsets(text, positions) == {(1, 1): (1, 0), (2, 1): (2, 0), (2, 5): (2, 5), (9, 4): (9, 0)}


class Cache:
    """Stand-in for the cache of code: what was loaded and stored."""

    def __init__(self) -> None:
        self.code: dict[str, Any] = {}
        self.kept: list[bool] = []

    def load(self, name: str) -> Any:
        return self.code.get(name)

    def store(self, name: str, code: Any, *, keep: bool) -> None:
        self.code[name] = code
        self.kept.append(keep)


def node_code(cache: Cache, plan: Any, overlay: Any = None, **more: Any) -> NodeCode:
    given: Any = {"publishes": (), "inline": False, "cache": cache, **more}
    return NodeCode(plan, overlay or {}, **given)


def test_code_is_compiled_once_per_text_and_plan(tmp_path: Path) -> None:
    path = tmp_path / "node.py"
    path.write_text("x = 1\ny = 2\n")
    cache, plan = Cache(), {path: {(1, 1): 0}}
    first = node_code(cache, plan).compile(path)
    assert node_code(cache, plan).compile(path) is first
    for changed in (
        node_code(cache, {path: {(2, 1): 0}}),
        node_code(cache, plan, publishes=(0,)),
        node_code(cache, plan, inline=True),
        node_code(cache, plan, {path: "x = 3\ny = 2\n"}),
    ):
        assert changed.compile(path) is not first
    assert cache.kept == [True, True, True, True, False]
    path.write_text("x = 1\ny = 3\n")
    assert node_code(cache, plan).compile(path) is not first


def test_only_files_with_sites_or_replacements_are_handled(tmp_path: Path) -> None:
    first, second, third = (tmp_path / f"{name}.py" for name in "abc")
    node = node_code(Cache(), {first: {(1, 1): 0}, third: {}}, {second: "é = 1\n"})
    assert node.files == {first.resolve(), second.resolve(), third.resolve()}
    assert [node.recorded(one.resolve()) for one in (first, second, third)] == [True, False, False]
    assert node.edited(second.resolve()) == "é = 1\n".encode()
    assert node.edited(first.resolve()) is None


def test_sites_without_a_place_are_named(tmp_path: Path) -> None:
    path = tmp_path / "node.py"
    path.write_text("x = 1\n")
    cache = Cache()
    node = node_code(cache, {path: {(1, 1): 0, (7, 1): 1}})
    node.compile(path)
    assert node.unrecorded == {path: ((7, 1),)}
    assert cache.kept == []
    whole = node_code(cache, {path: {(1, 1): 0}})
    whole.compile(path)
    assert (whole.unrecorded, cache.kept) == ({}, [True])


def test_sites_follow_their_lines_in_an_edited_text(tmp_path: Path) -> None:
    path = tmp_path / "node.py"
    path.write_text("x = 1\ny = 2\n")
    node = node_code(Cache(), {path: {(2, 1): 0}}, {path: "import os\nx = 1\ny = 2\n"})
    assert node._text(path.resolve())[2] == {(3, 1): 0}
    node.compile(path)
    assert node.unrecorded == {}


def test_a_program_without_a_source_position_is_named_unknown() -> None:
    from pytest_tarl.instrumentation.sites import _topics

    place = SimpleNamespace(path="a.py", line=3)
    assert _topics(SimpleNamespace(topics=("/a", "/b"))) == ("/a", "/b")
    assert _topics(SimpleNamespace(topics=(), span=place, api="publish")) == ("(publish at a.py:3)",)
    assert _topics(SimpleNamespace(topics=())) == ("(unknown)",)
