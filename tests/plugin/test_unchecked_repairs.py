"""Recorded tests of a repaired file against which a run did not check the repair."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from pytest_tarl import other_recordings
from pytest_tarl.errors import FixtureError
from pytest_tarl.other_recordings import unchecked


def recording(test: str, *paths: str) -> Any:
    sites = [SimpleNamespace(path=path) for path in paths]
    return SimpleNamespace(test=test, lists=[SimpleNamespace(sites=[one]) for one in sites])


def repair(*paths: str, accepted: bool = True) -> Any:
    return SimpleNamespace(accepted=accepted, edits=[SimpleNamespace(path=path) for path in paths])


@pytest.fixture
def tarl(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    found = {
        "a": recording("test_a", "pilot.py"),
        "b": FixtureError("b.npz is damaged.", "Record it again."),
        "c": recording("test_c", "map.py"),
        "d": FixtureError("d.npz is damaged.", "Record it again."),
        "e": recording("test_e", "map.py", "pilot.py"),
    }
    (tmp_path / "utility").mkdir()
    for name in found:
        (tmp_path / "utility" / f"{name}.npz").write_bytes(b"")

    def load(path: Path) -> Any:
        one = found[path.stem]
        if isinstance(one, Exception):
            raise one
        return one

    monkeypatch.setattr(other_recordings.fixtures, "load", load)
    return tmp_path


def notes(found: Any, run: set[str], tarl: Path) -> list[str]:
    return [one.split()[0] for one in unchecked(found, run, tarl)]


def test_each_other_recording_of_an_edited_file_is_named(tarl: Path) -> None:
    assert notes(repair("pilot.py"), set(), tarl) == ["test_a", "b.npz", "d.npz", "test_e"]
    assert notes(repair("pilot.py"), {"test_a"}, tarl) == ["b.npz", "d.npz", "test_e"]
    assert notes(repair("map.py"), {"test_a", "test_e"}, tarl) == ["b.npz", "test_c", "d.npz"]
    assert notes(repair("other.py"), set(), tarl) == ["b.npz", "d.npz"]


def test_without_an_accepted_repair_there_is_nothing_to_check(tarl: Path) -> None:
    assert notes(None, set(), tarl) == notes(repair("pilot.py", accepted=False), set(), tarl) == []
