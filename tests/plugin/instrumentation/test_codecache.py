from __future__ import annotations

from pathlib import Path

import pytest

from pytest_tarl.instrumentation.codecache import KEPT, REMEMBERED, CodeCache, entry_name

CODE = compile("x = 1", "node.py", "exec")
NAME = entry_name(Path("node.py"), ("text", 1))


@pytest.fixture(autouse=True)
def _bytecode_is_written(monkeypatch):
    monkeypatch.setattr("sys.dont_write_bytecode", False)


def test_code_survives_the_process(tmp_path):
    CodeCache(tmp_path / "cache").store(NAME, CODE)
    assert CodeCache(tmp_path / "cache").load(NAME) == CODE


def test_what_was_never_stored_is_not_there(tmp_path):
    assert CodeCache(tmp_path).load(NAME) is None


def test_names_differ_by_place_and_by_everything_that_code_depends_on():
    names = {
        entry_name(Path(path), parts) for path in ("a/node.py", "b/node.py") for parts in (("t", 1), ("t", 2))
    }
    assert len(names) == 4


@pytest.mark.parametrize(
    "damage",
    [
        lambda data: b"",
        lambda data: data[:-3],
        lambda data: data[:60] + bytes([data[60] ^ 1]) + data[61:],
        lambda data: b"x" + data,
    ],
)
def test_a_damaged_entry_is_as_none(tmp_path, damage):
    CodeCache(tmp_path).store(NAME, CODE)
    entry = tmp_path / NAME
    entry.write_bytes(damage(entry.read_bytes()))
    assert CodeCache(tmp_path).load(NAME) is None


def test_a_place_that_cannot_be_written_costs_no_more_than_a_compilation(tmp_path):
    (tmp_path / "cache").write_text("a file in the way")
    cache = CodeCache(tmp_path / "cache")
    cache.store(NAME, CODE)
    assert cache.load(NAME) is CODE


def test_nothing_is_written_where_python_writes_no_bytecode(tmp_path, monkeypatch):
    monkeypatch.setattr("sys.dont_write_bytecode", True)
    CodeCache(tmp_path / "cache").store(NAME, CODE)
    assert not (tmp_path / "cache").exists()


def test_no_temporary_file_stays_and_old_entries_of_a_file_go(tmp_path):
    cache = CodeCache(tmp_path)
    other = entry_name(Path("other.py"), ("text",))
    cache.store(other, CODE)
    for number in range(KEPT + 4):
        cache.store(entry_name(Path("node.py"), (number,)), CODE)
    names = [entry.name for entry in tmp_path.iterdir()]
    assert len(names) == KEPT + 1
    assert other in names


def test_memory_is_bounded():
    cache = CodeCache(None)
    for number in range(REMEMBERED + 1):
        cache.store(str(number), CODE)
    assert cache.load("0") is None
    assert cache.load(str(REMEMBERED)) is CODE
