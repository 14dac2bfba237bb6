"""All modules that import a dropped module are found, for every form of import, and no others."""

from __future__ import annotations

import importlib
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from pytest_tarl.stale_modules import holders

HOLDING = {
    "a module": "import dropped.inner as it\nRATE = it.RATE",
    "its package": "import dropped\nRATE = 3",
    "from a package": "from dropped import inner\nRATE = inner.RATE\ndel inner",
    "a constant": "from dropped.inner import RATE",
    "in a function": "def rate():\n    from dropped.inner import RATE\n    return RATE\nRATE = rate()",
    "in a method": "class A:\n    def rate(self):\n        import dropped.inner\n        return dropped.inner.RATE",
    "beside others": "import os, json\nfrom dropped import inner as _, inner\nRATE = inner.RATE",
    "relative": "from .inner import RATE",
    "relative, from the package": "from . import inner\nRATE = inner.RATE\ndel inner",
}
OTHERS = {
    "another module of that name": "from collections import abc as inner",
    "a name in a text": "RATE = 'dropped.inner'",
    "an attribute": "class A: inner = 1\nRATE = A.inner",
    "nothing": "RATE = 3",
}


@pytest.fixture
def package(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    folder = tmp_path / "dropped"
    folder.mkdir()
    (folder / "__init__.py").touch()
    (folder / "inner.py").write_text("RATE = 3\n")
    monkeypatch.syspath_prepend(tmp_path)
    before = set(sys.modules)
    yield folder
    for name in sys.modules.keys() - before:
        del sys.modules[name]


def found(package: Path, source: str, name: str) -> list[str]:
    path = package.parent.joinpath(*name.split(".")).with_suffix(".py")
    path.write_text(source)
    importlib.import_module(name)
    gone = [importlib.import_module("dropped.inner"), importlib.import_module("dropped")]
    return holders(gone, [name])


@pytest.mark.parametrize("kind", HOLDING)
def test_importer_of_a_dropped_module_is_stale(kind: str, package: Path) -> None:
    name = "dropped.user" if kind.startswith("relative") else "user_of_dropped"
    assert found(package, HOLDING[kind], name) == [name]


@pytest.mark.parametrize("kind", OTHERS)
def test_modules_without_a_stale_import_stay_imported(kind: str, package: Path) -> None:
    assert found(package, OTHERS[kind], "user_of_nothing") == []


def test_stale_modules_are_found_through_indirect_imports(package: Path) -> None:
    (package.parent / "first_user.py").write_text("from dropped.inner import RATE")
    (package.parent / "second_user.py").write_text("from first_user import RATE")
    importlib.import_module("second_user")
    gone = [importlib.import_module("dropped.inner")]
    assert holders(gone, ["first_user", "second_user"]) == ["first_user", "second_user"]
