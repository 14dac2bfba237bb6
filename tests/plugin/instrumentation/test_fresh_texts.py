"""Modules that a node imports from any folder are re-executed in each episode; otherwise the user is warned."""

from __future__ import annotations

import importlib
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from pytest_tarl.instrumentation.importhook import NodeImports
from pytest_tarl.instrumentation.launching import workspace
from pytest_tarl.instrumentation.recorder import Recorder

PLACES = ("workspace", "package", "tests", "site")
FORMS = {
    "module": "import {0}\n\n\ndef value():\n    return {0}.value()\n",
    "name": "from {0} import value\n",
    "number": "from {0} import NUMBER\n\n\ndef value():\n    return NUMBER\n",
    "constant": "import {0}\nKEPT = {0}.value()\n\n\ndef value():\n    return KEPT\n",
    "inside": "def value():\n    import {0}\n    return {0}.value()\n",
}
LEAF = "NUMBER = {0}\n\n\ndef value():\n    return {0}\n"


@pytest.fixture(autouse=True)
def as_found() -> Iterator[None]:
    path, modules = sys.path[:], set(sys.modules)
    yield
    sys.path[:] = path
    for name in set(sys.modules) - modules:
        del sys.modules[name]


def laid_out(top: Path, places: list[str], forms: list[str]) -> list[Path]:
    """Write a chain of modules, each importing the next; the last one defines the constant."""
    folders = {name: top / name for name in PLACES} | {"package": top / "workspace" / "src" / "other"}
    for folder in folders.values():
        folder.mkdir(parents=True, exist_ok=True)
        sys.path.insert(0, str(folder))
    (top / "workspace" / ".git").mkdir()
    names = [f"link{at}_{top.name.replace('-', '_')}" for at in range(len(places))]
    files = [folders[place] / f"{name}.py" for place, name in zip(places, names, strict=True)]
    for file, form, following in zip(files, forms, names[1:], strict=False):
        file.write_text(FORMS[form].format(following) + "\n\nNUMBER = value()\n")
    files[-1].write_text(LEAF.format(1))
    node = folders["workspace"] / "node.py"
    node.write_text(f"import {names[0]}\n\nout = {names[0]}.value()\n")
    importlib.invalidate_caches()
    return [node, *files]


def ran(root: Path, node: Path, overlay: dict[Path, str]) -> tuple[Any, tuple[Path, ...]]:
    recorder = Recorder()
    with NodeImports(
        root, {key: {} for key in overlay}, recorder.hook, overlay, bind=recorder.bind
    ) as imports:
        out = imports.run_script(node).out
    return out, imports.older


def edited(places: list[str], forms: list[str]) -> None:
    """Check that the node uses each new constant of the last module of a chain."""
    with tempfile.TemporaryDirectory() as folder:
        top = Path(folder).resolve()
        node, *files = laid_out(top, places, forms)
        leaf = files[-1]
        assert ran(top / "tests", node, {leaf: leaf.read_text()}) == (1, ())
        for value in (2, 3):
            assert ran(top / "tests", node, {leaf: LEAF.format(value)}) == (value, ())
        assert ran(top / "tests", node, {leaf: leaf.read_text()}) == (1, ())


@settings(max_examples=60, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.data())
def test_an_edited_module_is_executed_even_if_imported_indirectly(data: st.DataObject) -> None:
    places = data.draw(st.lists(st.sampled_from(PLACES), min_size=1, max_size=4), "places")
    forms = data.draw(st.lists(st.sampled_from(sorted(FORMS)), min_size=4, max_size=4), "forms")
    edited(places, forms)


def test_constant_read_from_an_edited_file_is_recomputed() -> None:
    edited(["workspace", "site", "workspace"], ["number", "inside", "constant"])


def test_old_copy_of_an_edited_helper_is_reported(tmp_path: Path) -> None:
    node, leaf = laid_out(tmp_path, ["workspace"], [])
    kept: list[Any] = []

    def keeping(value: Any) -> None:
        kept.append(value)

    node.write_text(
        f"import {leaf.stem}\nimport keeper_of_things as keeper\n"
        f"keeper.first = getattr(keeper, 'first', None) or {leaf.stem}.value\nout = keeper.first()\n"
    )
    (tmp_path / "site" / "keeper_of_things.py").write_text("")
    importlib.invalidate_caches()
    importlib.import_module("keeper_of_things")
    assert ran(tmp_path / "tests", node, {leaf: leaf.read_text()}) == (1, ())
    text = "import sys\nimport keeper_of_things as keeper\nout = keeper.first()\n"
    out, older = ran(tmp_path / "tests", node, {node: text, leaf: LEAF.format(2)})
    assert (out, older) == (1, (leaf,))


def test_file_edited_after_its_import_is_reported(tmp_path: Path) -> None:
    node, leaf = laid_out(tmp_path, ["workspace"], [])
    importlib.import_module(leaf.stem)
    with pytest.warns(UserWarning, match="was imported"):
        assert ran(tmp_path / "tests", node, {leaf: LEAF.format(2)}) == (1, (leaf,))


def test_an_unused_edited_file_is_not_an_error(tmp_path: Path) -> None:
    node, leaf = laid_out(tmp_path, ["workspace"], [])
    node.write_text("out = 7\n")
    assert ran(tmp_path / "tests", node, {leaf: LEAF.format(2)}) == (7, ())


@pytest.mark.parametrize(
    ("marks", "expected"),
    [
        ((".git/",), "."),
        (("ws/build/",), "ws"),
        (("ws/src/pkg/package.xml",), "ws/src/pkg"),
        (("ws/package.xml", "ws/src/pkg/setup.py"), "ws"),
        (("ws/src/pkg/pyproject.toml", ".git/"), "."),
        ((), "ws/src/pkg/scripts"),
        (("ws/src/pkg/scripts/__init__.py",), "ws/src/pkg"),
    ],
)
def test_the_workspace_of_a_node_is_found(tmp_path: Path, marks: tuple[str, ...], expected: str) -> None:
    file = tmp_path / "ws/src/pkg/scripts/node.py"
    file.parent.mkdir(parents=True)
    file.touch()
    for mark in marks:
        path = tmp_path / mark
        path.parent.mkdir(parents=True, exist_ok=True)
        path.mkdir() if mark.endswith("/") else path.touch()
    assert workspace(file) == (tmp_path / expected).resolve()
