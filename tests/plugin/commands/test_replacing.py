"""Several files are replaced together: content, mode and durability, and nothing at all after a failure."""

from __future__ import annotations

import os
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Any

import pytest

from pytest_tarl.commands import replacing
from pytest_tarl.commands.replacing import Change, MovedError, replace_all

pytestmark = pytest.mark.skipif(not replacing.RELATIVE, reason="files are opened relative to folders")


@pytest.fixture
def files(tmp_path: Path) -> list[Path]:
    made = [tmp_path / "a.py", tmp_path / "in" / "b.py"]
    made[1].parent.mkdir()
    for path in made:
        path.write_bytes(b"old")
        path.chmod(0o640)
    return made


def change(path: Path, before: bytes = b"old", after: bytes = b"new content") -> Change:
    return Change(path, path.parents[1] if path.parent.name == "in" else path.parent, before, after)


def names(root: Path) -> set[str]:
    return {path.relative_to(root).as_posix() for path in root.rglob("*") if path.is_file()}


def test_all_files_get_their_content_and_keep_their_mode(files: list[Path], tmp_path: Path) -> None:
    replace_all([change(path) for path in files])
    assert [path.read_bytes() for path in files] == [b"new content"] * 2
    assert {path.stat().st_mode & 0o777 for path in files} == {0o640}
    assert names(tmp_path) == {"a.py", "in/b.py"}


def test_content_is_on_disk_before_a_file_is_replaced(
    files: list[Path], monkeypatch: pytest.MonkeyPatch
) -> None:
    synced: list[tuple[int, bytes]] = []
    replaced: list[int] = []
    replace, sync = os.replace, os.fsync

    def syncing(handle: int) -> None:
        synced.append((os.fstat(handle).st_mode & 0o777, Path(f"/proc/self/fd/{handle}").read_bytes()))
        sync(handle)

    def replacing_(*given: Any, **named: Any) -> None:
        replaced.append(len(synced))
        replace(*given, **named)

    if not Path("/proc/self/fd").exists():
        pytest.skip("needs /proc")
    monkeypatch.setattr(os, "fsync", syncing)
    monkeypatch.setattr(os, "replace", replacing_)
    replace_all([change(path) for path in files])
    assert synced == [(0o640, b"new content")] * 2
    assert replaced == [2, 2]


def test_the_owner_is_kept(files: list[Path], monkeypatch: pytest.MonkeyPatch) -> None:
    given: list[tuple[int, int]] = []

    def own(_: int, user: int, group: int) -> None:
        given.append((user, group))
        raise PermissionError

    monkeypatch.setattr(os, "fchown", own)
    status = files[0].stat()
    replace_all([change(files[0])])
    assert given == [(status.st_uid, status.st_gid)]
    assert files[0].stat().st_mode & 0o777 == 0o640


@pytest.mark.parametrize("links", [True, False])
@pytest.mark.parametrize("failing", [0, 1, 2, 3])
def test_a_failure_leaves_all_files_unchanged(
    files: list[Path], tmp_path: Path, monkeypatch: pytest.MonkeyPatch, links: bool, failing: int
) -> None:
    """Fail at one of the two files that are written (0, 1) or of the two that are replaced (2, 3)."""
    calls = 0
    replace, sync = os.replace, os.fsync

    def counted(usual: Callable[..., Any], at: int) -> Callable[..., Any]:
        def called(*given: Any, **named: Any) -> Any:
            nonlocal calls
            calls += 1
            if calls == at + 1:
                raise OSError(28, "full")
            return usual(*given, **named)

        return called

    if not links:

        def refused(*_: Any, **__: Any) -> None:
            raise NotImplementedError

        monkeypatch.setattr(os, "link", refused)
    if failing < 2:
        monkeypatch.setattr(os, "fsync", counted(sync, failing if links else 2 * failing))
    else:
        monkeypatch.setattr(os, "replace", counted(replace, failing - 2))
    with pytest.raises(OSError, match="full"):
        replace_all([change(path) for path in files])
    assert [path.read_bytes() for path in files] == [b"old"] * 2
    assert {path.stat().st_mode & 0o777 for path in files} == {0o640}
    assert names(tmp_path) == {"a.py", "in/b.py"}


def test_a_file_whose_content_has_changed_is_not_replaced(files: list[Path]) -> None:
    with pytest.raises(MovedError) as raised:
        replace_all([change(files[0]), change(files[1], b"other")])
    assert raised.value.path == files[1]
    assert [path.read_bytes() for path in files] == [b"old"] * 2


def gone(path: Path) -> None:
    path.unlink()


def linked(path: Path) -> None:
    path.rename(path.with_name("real"))
    path.symlink_to("real")


def piped(path: Path) -> None:
    path.unlink()
    os.mkfifo(path)


def folder_gone(path: Path) -> None:
    path.parent.rename(path.parent.with_name("other"))


def folder_linked(path: Path) -> None:
    folder_gone(path)
    path.parent.symlink_to("other")


@pytest.mark.parametrize("moving", [gone, linked, piped, folder_gone, folder_linked])
def test_directory_or_link_is_not_replaced(files: list[Path], moving: Callable[[Path], None]) -> None:
    moving(files[1])
    with pytest.raises(MovedError) as raised:
        replace_all([change(files[0]), change(files[1])])
    assert raised.value.path == files[1]
    assert files[0].read_bytes() == b"old"


def test_a_permission_error_of_the_system_is_raised(
    files: list[Path], monkeypatch: pytest.MonkeyPatch
) -> None:
    opening = os.open

    def denied(path: Any, *given: Any, **named: Any) -> int:
        if str(path) in ("b.py", "in"):
            raise PermissionError(13, "denied")
        return opening(path, *given, **named)

    monkeypatch.setattr(os, "open", denied)
    for path in (files[1], files[0]):
        if path == files[0]:
            replace_all([change(path)])
            continue
        with pytest.raises(PermissionError):
            replace_all([change(path)])


@pytest.mark.skipif(not Path("/proc/self/fd").is_dir(), reason="needs the list of open files")
@pytest.mark.parametrize("content", [b"before", b"edited"])
def test_replacing_files_closes_every_folder_that_it_opens(tmp_path: Path, content: bytes) -> None:
    path = tmp_path / "src" / "robot" / "node.py"
    path.parent.mkdir(parents=True)
    path.write_bytes(content)
    count = len([*Path("/proc/self/fd").iterdir()])
    with suppress(MovedError):
        replace_all([Change(path, tmp_path, b"before", b"after")])
    assert len([*Path("/proc/self/fd").iterdir()]) == count
