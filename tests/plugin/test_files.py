"""A check whether a file can be written leaves nothing behind."""

import errno
import os

import pytest

from pytest_tarl.files import check_writable


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
