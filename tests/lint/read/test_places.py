"""Files, folders and environments from which sources are read."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from tarl_lint.errors import UsageError
from tarl_lint.read import source
from tarl_lint.read.discover import find
from tarl_lint.read.installed import search_path, version
from tarl_lint.read.source import SourceError, contents, parse
from tarl_lint.settings.config import Config
from tarl_lint.workspace.bounded_files import UnreadableError, read_bytes, read_text


def refused(path: Path) -> str:
    found = contents(path, "a.py")
    assert isinstance(found, SourceError)
    assert (found.path, found.line) == ("a.py", 1)
    return found.message


def test_a_file_is_read_up_to_two_million_bytes(tmp_path, monkeypatch):
    monkeypatch.setattr(source, "LARGEST", 8)
    (tmp_path / "a.py").write_bytes(b"12345678")
    assert contents(tmp_path / "a.py", "a.py") == b"12345678"
    (tmp_path / "a.py").write_bytes(b"123456789")
    assert refused(tmp_path / "a.py").startswith("The file has more than 0 MB: move data out of the code")
    assert contents(tmp_path / "a.py", "a.py", b"typed") == b"typed", (
        "text from standard input replaces the file"
    )


def test_a_pipe_and_a_missing_file_are_refused(tmp_path):
    os.mkfifo(tmp_path / "pipe")
    assert refused(tmp_path / "pipe").startswith("This is not a regular file")
    assert refused(tmp_path / "none") == (
        "This file cannot be read: No such file or directory. Make it readable, or exclude it."
    )


@pytest.mark.parametrize(
    ("data", "line", "message"),
    [
        (b"# coding: rot13\nx = 1\n", 1, "Unknown encoding: "),
        (b"# coding: nothing\nx = 1\n", 1, "Unknown encoding: "),
        (b"x = 1\ny = '\xff'\n", 2, "The bytes are not valid utf-8: "),
        (b"x = 1\n\ny = '\0'\n", 3, "The file contains a null byte"),
        (b"print 'x'\n", 1, "This is Python 2"),
        (b"try:\n  pass\nexcept A, e:\n  pass\n", 3, "This is Python 2"),
        (b"x = 1\nx = = 1\n", 2, "The file is not valid Python (invalid syntax): fix this line"),
        (b"(" * 300 + b")" * 300, 1, "The file is not valid Python (too many nested parentheses): "),
    ],
)
def test_file_that_is_not_python_is_reported_with_its_line(data, line, message):
    found = parse("a.py", data, "a")
    assert isinstance(found, SourceError)
    assert (found.line, found.bug) == (line, False)
    assert found.message.startswith(message)


def test_a_file_is_read_only_up_to_the_given_size(tmp_path):
    (tmp_path / "a").write_bytes("ä\n".encode("latin-1"))
    assert read_bytes(tmp_path / "a", 2) == b"\xe4\n"
    assert read_text(tmp_path / "a", 2) == "�\n"
    with pytest.raises(UnreadableError, match="it has more than 1 bytes"):
        read_bytes(tmp_path / "a", 1)
    with pytest.raises(UnreadableError, match="it is a folder, a named pipe or a device, not a file"):
        read_bytes(tmp_path, 9)
    with pytest.raises(UnreadableError, match="it cannot be read: No such file or directory"):
        read_bytes(tmp_path / "none", 9)


def test_a_broken_link_names_its_target(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("link.py").symlink_to("gone.py")
    with pytest.raises(UsageError, match=r"^link.py is a broken link to gone.py: name the file itself\.$"):
        find([Path("link.py")], Config())


def test_a_circular_link_counts_as_missing_and_is_skipped(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("loop.py").symlink_to("loop.py")
    Path("a.py").touch()
    assert [one.shown for one in find([Path()], Config()).files] == ["a.py"]
    with pytest.raises(UsageError, match="broken link"):
        find([Path("loop.py")], Config())


@pytest.fixture
def environment(tmp_path: Path) -> Path:
    """Return a virtual environment without packages."""
    (tmp_path / "env/lib/python3.11/site-packages").mkdir(parents=True)
    (tmp_path / "env/lib64/python3.11").mkdir(parents=True)
    (tmp_path / "env/lib64/python3.11/site-packages").symlink_to(
        tmp_path / "env/lib/python3.11/site-packages"
    )
    (tmp_path / "env/pyvenv.cfg").write_text("version = 3.11\n")
    return tmp_path / "env"


def test_a_folder_reached_by_two_names_is_searched_once(environment):
    (site,) = {one.resolve() for one in search_path(environment)}
    assert len(search_path(environment)) == 1
    assert site == environment / "lib/python3.11/site-packages"


def test_folders_listed_in_pth_files_come_last(environment):
    site = environment / "lib/python3.11/site-packages"
    (environment / "src").mkdir()
    (site / "below").mkdir()
    (site / "b.pth").write_text(f"{environment}/src\nimport os\nimport\tos\n# x\n\n/no/such\n  below  \n")
    (site / "a.pth").mkdir()
    found = search_path(environment)
    assert found[0].resolve() == site
    assert [one.resolve() for one in found[1:]] == [environment / "src", site / "below"]


@pytest.mark.parametrize(
    ("folder", "files", "found"),
    [
        ("arm-1.2.dist-info", {"METADATA": "Name: arm\nVersion: 1.2\n"}, "1.2"),
        ("ARM-1.2.dist-info", {"METADATA": "Version:  1.2 \n"}, "1.2"),
        ("far-1.2.dist-info", {"METADATA": "Version: 1.2\n", "top_level.txt": "x\narm\n"}, "1.2"),
        ("far-1.2.dist-info", {"METADATA": "Version: 1.2\n", "RECORD": "x,,\narm/__init__.py,,\n"}, "1.2"),
        ("far-1.2.dist-info", {"METADATA": "Version: 1.2\n", "RECORD": "arm.py,,\n"}, "1.2"),
        ("far-1.2.dist-info", {"METADATA": "Version: 1.2\n", "RECORD": "arms/x.py,,\nx/arm/y.py,,\n"}, ""),
        ("arm-1.2.dist-info", {}, ""),
        ("arm-1.2.dist-info", {"METADATA": "The Version: 1.2\n"}, ""),
    ],
)
def test_an_installed_package_has_the_version_of_its_distribution(environment, folder, files, found):
    place = environment / "lib/python3.11/site-packages" / folder
    place.mkdir()
    for name, text in files.items():
        (place / name).write_text(text)
    assert version(search_path(environment), "arm") == found
