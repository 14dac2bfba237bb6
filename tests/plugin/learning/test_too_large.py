"""A recording that memory does not suffice for is refused in a sentence before it is unpacked."""

from __future__ import annotations

from pathlib import Path

import pytest

from pytest_tarl import free_memory
from pytest_tarl.errors import FixtureError
from pytest_tarl.learning import archive
from pytest_tarl.learning.fixture import load, save
from tests.plugin.learning.test_fixture import example


def test_a_recording_is_read_only_where_there_is_the_memory(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "a.npz"
    save(example(), path)
    monkeypatch.setattr(archive, "available", lambda: 1000)
    with pytest.raises(
        FixtureError, match=r"a\.npz takes about .* GB of memory to read, and 0\.0 GB are free.*fewer"
    ):
        load(path)
    for free in (10**12, None):
        monkeypatch.setattr(archive, "available", lambda free=free: free)
        assert load(path).test == "test_node.py::test_it"


def test_free_memory_is_what_the_system_says(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    meminfo = tmp_path / "meminfo"
    monkeypatch.setattr(free_memory, "_MEMINFO", meminfo)
    assert free_memory.available() is None
    meminfo.write_text("MemTotal:       100 kB\nMemAvailable:     77 kB\nBuffers:    3 kB\n")
    assert free_memory.available() == 77 * 1024
    meminfo.write_text("nothing of it\n")
    assert free_memory.available() is None
