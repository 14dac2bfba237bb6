"""Tests are chosen for a module by name, by the number of imports in between, and by folder."""

from __future__ import annotations

import importlib.util
from pathlib import Path
from typing import Any

import pytest

FILES = {
    "pack/__init__.py": "",
    "pack/low.py": "",
    "pack/part/__init__.py": "",
    "pack/part/middle.py": "from pack import low\n",
    "pack/part/high.py": "from pack.part.middle import x\n",
    "pack/aside.py": "import os\n",
    "tests/test_low.py": "",
    "tests/test_direct.py": "import pack.low\n",
    "tests/test_middle_by_hand.py": "",
    "tests/part/test_any.py": "from pack.part.middle import x\n# longer than the next one\n",
    "tests/test_other.py": "from pack.part.middle import x\n",
    "tests/test_high.py": "from pack.part import high\n",
    "tests/test_none.py": "from . import low\n",
}


@pytest.fixture
def nearest(tmp_path: Path) -> Any:
    file = Path(__file__).parent.parent / "benchmarks" / "nearest_tests.py"
    spec = importlib.util.spec_from_file_location("nearest_tests", file)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    with pytest.MonkeyPatch.context() as patched:
        patched.setitem(__import__("sys").modules, "nearest_tests", module)
        spec.loader.exec_module(module)
    for name, text in FILES.items():
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text(text)
    return module.Nearest(tmp_path, "pack", ("tests",))


def test_the_nearest_test_files_come_first(nearest: Any) -> None:
    every = ["test_low.py", "test_direct.py", "test_other.py", "part/test_any.py", "test_high.py"]
    assert nearest.files("pack/low.py", 9) == [f"tests/{one}" for one in every]
    assert nearest.files("pack/low.py", 2) == ["tests/test_low.py", "tests/test_direct.py"]
    found = nearest.files("pack/part/middle.py", 9)
    assert found == [
        f"tests/{one}"
        for one in ("test_middle_by_hand.py", "part/test_any.py", "test_other.py", "test_high.py")
    ]
    assert nearest.files("pack/aside.py", 9) == []
