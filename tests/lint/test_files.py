"""Files are written atomically; pipes and devices are never replaced by files."""

import os
import stat
import threading

from tarl_lint.files import write_whole


def test_a_file_is_replaced_and_keeps_its_mode(tmp_path):
    target = tmp_path / "flows.json"
    target.write_text("old")
    target.chmod(0o640)
    write_whole(target, "new\n")
    assert target.read_text() == "new\n"
    assert stat.S_IMODE(target.stat().st_mode) == 0o640
    assert [p.name for p in tmp_path.iterdir()] == ["flows.json"]


def test_a_pipe_or_device_is_written_to_and_not_replaced(tmp_path):
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    read = []
    reader = threading.Thread(target=lambda: read.append(pipe.read_text()))
    reader.start()
    write_whole(pipe, "flows\n")
    reader.join(timeout=20)
    assert read == ["flows\n"]
    assert stat.S_ISFIFO(pipe.stat().st_mode)
    assert [p.name for p in tmp_path.iterdir()] == ["pipe"]
