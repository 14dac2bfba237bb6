"""Files are written atomically; pipes and devices are never replaced by files."""

import os
import stat
import threading

import pytest

from tarl_lint.files import write_atomically


def test_a_file_is_replaced_and_keeps_its_mode(tmp_path):
    target = tmp_path / "flows.json"
    target.write_text("old")
    target.chmod(0o640)
    write_atomically(target, b"new\n")
    assert target.read_text() == "new\n"
    assert stat.S_IMODE(target.stat().st_mode) == 0o640
    assert [p.name for p in tmp_path.iterdir()] == ["flows.json"]


def test_pipe_or_device_is_not_replaced(tmp_path):
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    read = []
    reader = threading.Thread(target=lambda: read.append(pipe.read_text()))
    reader.start()
    write_atomically(pipe, b"flows\n")
    reader.join(timeout=20)
    assert read == ["flows\n"]
    assert stat.S_ISFIFO(pipe.stat().st_mode)
    assert [p.name for p in tmp_path.iterdir()] == ["pipe"]


def test_missing_folders_are_made_on_request(tmp_path):
    target = tmp_path / "new" / "report.html"
    with pytest.raises(FileNotFoundError):
        write_atomically(target, b"old")
    write_atomically(target, b"old", parents=True)
    write_atomically(target, b"new", parents=True)
    assert target.read_bytes() == b"new"
    assert [p.name for p in target.parent.iterdir()] == ["report.html"]


@pytest.mark.parametrize("goal", ["flows.json", "loop"])
def test_a_link_is_followed_unless_it_leads_to_itself(tmp_path, goal):
    (tmp_path / "loop").symlink_to(tmp_path / goal)
    write_atomically(tmp_path / "loop", b"new", through_links=True)
    assert (tmp_path / goal).read_bytes() == b"new"
    assert (tmp_path / "loop").is_symlink() == (goal != "loop")


def test_a_link_in_a_project_is_replaced(tmp_path):
    (tmp_path / "outside").write_bytes(b"old")
    (tmp_path / "link").symlink_to(tmp_path / "outside")
    write_atomically(tmp_path / "link", b"new")
    assert (tmp_path / "outside").read_bytes() == b"old"
    assert not (tmp_path / "link").is_symlink()
    assert (tmp_path / "link").read_bytes() == b"new"


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
