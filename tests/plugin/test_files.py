"""Reports and recordings are written atomically; pipes and devices are not replaced by files."""

import errno
import os
import stat
import threading

import pytest

from pytest_tarl.files import check_writable, write_atomically


def test_a_file_is_replaced_atomically(tmp_path):
    target = tmp_path / "new" / "report.html"
    write_atomically(target, b"old")
    write_atomically(target, b"new")
    assert target.read_bytes() == b"new"
    assert [p.name for p in target.parent.iterdir()] == ["report.html"]


def test_a_pipe_or_device_is_written_to_and_not_replaced(tmp_path):
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    read: list[bytes] = []
    reader = threading.Thread(target=lambda: read.append(pipe.read_bytes()))
    reader.start()
    write_atomically(pipe, b"report")
    reader.join(timeout=20)
    assert read == [b"report"]
    assert stat.S_ISFIFO(pipe.stat().st_mode)
    assert [p.name for p in tmp_path.iterdir()] == ["pipe"]


def test_an_interrupt_is_passed_on_before_and_after_the_rename(tmp_path, monkeypatch):
    rename = type(tmp_path).replace
    target = tmp_path / "report.html"

    def interrupted(path, new):
        if before:
            raise KeyboardInterrupt
        rename(path, new)
        raise KeyboardInterrupt

    monkeypatch.setattr(type(tmp_path), "replace", interrupted)
    for before, content in ((True, b""), (False, b"new")):
        with pytest.raises(KeyboardInterrupt):
            write_atomically(target, b"new")
        assert (target.read_bytes() if target.exists() else b"") == content
        assert [path.name for path in tmp_path.iterdir()] == ["report.html"] * (not before)


@pytest.mark.parametrize("there", ["", "a", "a/b"])
def test_checking_whether_a_file_is_writable_leaves_nothing_behind(tmp_path, there):
    (tmp_path / there).mkdir(parents=True, exist_ok=True)
    before = sorted(tmp_path.rglob("*"))
    check_writable(tmp_path / "a" / "b" / "c.npz")
    assert sorted(tmp_path.rglob("*")) == before


def test_a_write_error_is_raised_and_leaves_no_temporary_file(tmp_path):
    (tmp_path / "a").write_text("a file")
    with pytest.raises(OSError, match="a"):
        check_writable(tmp_path / "a" / "b" / "c.npz")
    assert [path.name for path in tmp_path.rglob("*")] == ["a"]


def test_a_disk_on_which_only_empty_files_fit_is_not_writable(tmp_path, monkeypatch):
    opened = os.fdopen

    def full(handle, mode):
        os.close(handle)
        return opened(os.open("/dev/full", os.O_WRONLY), mode)

    monkeypatch.setattr("pytest_tarl.files.os.fdopen", full)
    with pytest.raises(OSError, match="No space left") as problem:
        check_writable(tmp_path / "a" / "b.npz")
    assert problem.value.errno == errno.ENOSPC
    assert list(tmp_path.iterdir()) == []
