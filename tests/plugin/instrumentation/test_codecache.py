from __future__ import annotations

import os
from pathlib import Path

import pytest

from pytest_tarl.instrumentation import codecache
from pytest_tarl.instrumentation.codecache import KEPT, REMEMBERED, CodeCache, entry_name

CODE = compile("x = 1", "node.py", "exec")
NAME = entry_name(Path("node.py"), ("text", 1))


@pytest.fixture(autouse=True)
def _bytecode_is_written(monkeypatch):
    monkeypatch.setattr("sys.dont_write_bytecode", False)


def test_cached_code_is_loaded_in_another_process(tmp_path):
    CodeCache(tmp_path / "cache").store(NAME, CODE)
    assert CodeCache(tmp_path / "cache").load(NAME) == CODE


def test_a_missing_entry_returns_none(tmp_path):
    assert CodeCache(tmp_path).load(NAME) is None


def test_cache_keys_contain_path_and_dependencies():
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
def test_a_damaged_entry_returns_none(tmp_path, damage):
    CodeCache(tmp_path).store(NAME, CODE)
    entry = tmp_path / NAME
    entry.write_bytes(damage(entry.read_bytes()))
    assert CodeCache(tmp_path).load(NAME) is None


def test_an_unwritable_cache_only_causes_a_recompilation(tmp_path):
    (tmp_path / "cache").write_text("a file in the way")
    cache = CodeCache(tmp_path / "cache")
    cache.store(NAME, CODE)
    assert cache.load(NAME) is CODE


def test_nothing_is_written_without_bytecode(tmp_path, monkeypatch):
    monkeypatch.setattr("sys.dont_write_bytecode", True)
    CodeCache(tmp_path / "cache").store(NAME, CODE)
    assert not (tmp_path / "cache").exists()


def test_temporary_files_and_old_entries_are_removed(tmp_path):
    cache = CodeCache(tmp_path)
    other = entry_name(Path("other.py"), ("text",))
    cache.store(other, CODE)
    for number in range(KEPT + 4):
        cache.store(entry_name(Path("node.py"), (number,)), CODE)
    names = [entry.name for entry in tmp_path.iterdir()]
    assert len(names) == KEPT + 1
    assert other in names


def test_the_newest_entries_of_a_file_are_kept(tmp_path: Path) -> None:
    names = [entry_name(Path("node.py"), (number,)) for number in range(KEPT + 2)]
    for age, name in enumerate(reversed(names)):  # the first name is the newest
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_bytes(b"")
        os.utime(tmp_path / name, ns=(age, age))
    codecache._forget_old(tmp_path / names[0])
    assert {path.name for path in tmp_path.iterdir()} == {Path(name).name for name in names[:KEPT]}


def test_entries_in_memory_are_bounded():
    cache = CodeCache(None)
    for number in range(REMEMBERED + 1):
        cache.store(str(number), CODE)
    assert cache.load("0") is None
    assert cache.load(str(REMEMBERED)) is CODE


def test_an_entry_that_cannot_be_kept_leaves_no_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def full(*_: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(Path, "replace", full)
    with pytest.raises(OSError, match="No space"):
        codecache._write(tmp_path / "entry.bin", compile("1", "x", "exec"))
    assert not any(tmp_path.iterdir())
