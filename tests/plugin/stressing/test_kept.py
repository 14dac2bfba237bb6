"""Files and databases of stress runs that are damaged or cannot be written."""

from __future__ import annotations

import errno
import json
import os
from pathlib import Path
from tempfile import mkdtemp
from typing import Any

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from pytest_tarl import Drift
from pytest_tarl.spaces import Point
from pytest_tarl.stressing import kept
from pytest_tarl.stressing.delivering import _written
from pytest_tarl.stressing.findings import failure
from pytest_tarl.stressing.words import shown
from tests.plugin.stressing.worlds import space_of, stressed

MANY = 3000 if os.environ.get("TARL_SLOW") else 100
SPACE = space_of(mud=Drift.range(0.0, 1.0, nominal=1.0), camera=Drift.choice("up", "down"))
WHOLE = {"mud": 0.5, "camera": 1.0}
KEY = "test_a.py::test_a[world]"
NUMBERS = st.one_of(st.integers(), st.floats(), st.booleans(), st.none(), st.text(max_size=3))
LEAVES = st.one_of(NUMBERS, st.fixed_dictionaries({"mud": NUMBERS, "camera": NUMBERS}))
VALUES = st.one_of(
    LEAVES, st.lists(LEAVES, max_size=3), st.dictionaries(st.text(max_size=3), LEAVES, max_size=2)
)


def cliff(point: Point, draws: np.random.Generator) -> tuple[bool, float]:
    return point["mud"] > 0.5, float(draws.normal(1.0, 0.01))


def check(content: bytes, folder: Path) -> None:
    """All points that are read lie inside the space and differ from its nominal point."""
    for point in stored(content, folder).read(SPACE):
        assert point != SPACE.nominal
        assert 0.0 <= point["mud"] <= 1.0
        assert [shown(extent, point[name]) for name, extent in SPACE.extents.items()]
        assert SPACE.world(point)["camera"] in ("up", "down")


def stored(content: bytes, folder: Path) -> kept.Kept:
    """Return a database with one entry of this content."""
    memory = kept.Kept(Path(mkdtemp(dir=folder)), KEY)
    memory.write([failure(SPACE, WHOLE)])
    entry(memory.folder).write_bytes(content)
    return memory


def entry(folder: Path) -> Path:
    """Return the file of the only stored drift."""
    (found,) = [one for one in folder.rglob("*") if one.is_file() and one.read_bytes().startswith(b"{")]
    return found


@settings(max_examples=MANY)
@given(VALUES)
@example([{"mud": 1.0, "camera": 0.0}])
@example([{"mud": float("nan"), "camera": 0.0}])
def test_other_values_in_a_file_of_failures_are_ignored(
    tmp_path_factory: pytest.TempPathFactory, value: Any
) -> None:
    check(json.dumps(value).encode("utf-8", "surrogatepass"), tmp_path_factory.getbasetemp())


@settings(max_examples=MANY)
@given(st.integers(0, len(json.dumps(WHOLE)) - 1), st.integers(0, 255))
def test_changed_byte_in_a_failure_file_is_harmless(
    tmp_path_factory: pytest.TempPathFactory, place: int, byte: int
) -> None:
    content = bytearray(json.dumps(WHOLE).encode())
    content[place] = byte
    check(bytes(content), tmp_path_factory.getbasetemp())


@pytest.mark.parametrize("content", [b"[" * 100_000, b"9" * 100_000, b"\xff\xfe", b"\0"])
def test_entries_of_kept_failures_with_unexpected_contents_are_ignored(
    tmp_path: Path, content: bytes
) -> None:
    assert stored(content, tmp_path).read(SPACE) == []


def test_file_in_place_of_the_database_is_kept(tmp_path: Path) -> None:
    (tmp_path / "failing").write_text("mine")
    memory = kept.Kept(tmp_path / "failing", KEY)
    assert memory.read(SPACE) == []
    with pytest.raises(OSError, match=r"director|exists"):
        memory.write([failure(SPACE, WHOLE)])
    assert (tmp_path / "failing").read_text() == "mine"


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="this system has no named pipes")
def test_a_pipe_in_the_database_is_refused(tmp_path: Path) -> None:
    memory = stored(b"{}", tmp_path)
    path = entry(memory.folder)
    path.unlink()
    os.mkfifo(path)
    assert memory.read(SPACE) == []
    with pytest.raises(OSError, match="not a regular file"):
        memory.write([failure(SPACE, WHOLE)])


@pytest.mark.parametrize(
    ("number", "advice"),
    [
        (errno.ENOSPC, "free some space"),
        (errno.EROFS, "make the folder writable"),
        (errno.EFBIG, "ulimit -f"),
    ],
)
def test_one_line_names_unwritten_files(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, number: int, advice: str
) -> None:
    found = stressed(cliff, space_of(mud=Drift.range(0.0, 1.0, nominal=1.0)))
    memory = kept.Kept(tmp_path / ".tarl" / "stress" / "failing", KEY)
    assert _written(found, tmp_path, "x", memory) == ["report     .tarl/report/x-stress.html"]

    def full(path: Path) -> None:
        raise OSError(number, os.strerror(number))

    monkeypatch.setattr("pytest_tarl.files.open_beside", full)
    monkeypatch.setattr("tarl_lint.files.open_beside", full)
    (line,) = _written(found, tmp_path, "x", memory)
    assert line.startswith(
        "not written: .tarl/stress/x.json, .tarl/report/x-stress.html, "
        ".tarl/margins/x.json, .tarl/stress/failing"
    )
    assert advice in line
    assert line.endswith("The result above stands.")


def test_the_nearest_failures_are_kept_in_order(tmp_path: Path) -> None:
    failures = [failure(SPACE, {"mud": 0.9 - n / 10, "camera": 0.0}) for n in range(kept.MOST + 2)]
    memory = kept.Kept(tmp_path, KEY)
    memory.write(failures)
    assert memory.read(SPACE) == [one.point for one in failures[: kept.MOST]]
