"""Where the files of a patch are, and which files are refused."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from pytest_tarl.errors import RefusedError, RepairError
from pytest_tarl.patching.patched_files import located


def patch(*names: str, root: Path | None = None, base: str = ".") -> Any:
    """Return a patch of files; `root` is the folder that contains `.tarl`."""
    files = tuple(SimpleNamespace(name=name) for name in names)
    return SimpleNamespace(name="fix.patch", files=files, root=root, base=base)


@pytest.fixture
def repository(tmp_path: Path) -> Path:
    """A git repository with a node in a package."""
    root = (tmp_path / "repository").resolve()
    for folder in (".git", "pkg/src", "other"):
        (root / folder).mkdir(parents=True)
    (root / "pkg" / "src" / "node.py").write_text("")
    (root / "pkg" / "params.yaml").write_text("")
    return root


def test_paths_are_relative_to_the_base_of_the_patch(repository: Path) -> None:
    files = [repository / "pkg" / "src" / "node.py", repository / "pkg" / "params.yaml"]
    names = ("src/node.py", "params.yaml")
    assert located(patch(*names, root=repository / "pkg"), None) == (repository, files)
    assert located(patch(*names, root=repository, base="pkg"), None) == (repository, files)
    assert located(patch(*names, root=repository / "other", base="../pkg"), None) == (repository, files)


def test_a_named_folder_is_the_project(repository: Path) -> None:
    folder = repository / "pkg"
    assert located(patch("src/node.py"), folder) == (folder, [folder / "src" / "node.py"])
    with pytest.raises(RepairError, match=r"changes node.py, but .*pkg has no such file"):
        located(patch("node.py"), folder)
    with pytest.raises(RefusedError, match="leads out of"):
        located(patch("pkg/../../secret.py"), repository_with_secret(repository))


def repository_with_secret(repository: Path) -> Path:
    (repository.parent / "secret.py").write_text("")
    return repository


def test_patch_is_placed_between_folder_and_repository(
    repository: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    node = repository / "pkg" / "src" / "node.py"
    for folder, name in (("pkg/src", "node.py"), ("pkg/src", "src/node.py"), ("pkg", "src/node.py")):
        monkeypatch.chdir(repository / folder)
        assert located(patch(name), None) == (repository, [node])
    monkeypatch.chdir(repository / "other")
    assert located(patch("pkg/src/node.py"), None) == (repository, [node])
    (repository.parent / "outside.py").write_text("")
    with pytest.raises(RepairError, match=r"changes outside.py, but .*other has no such file"):
        located(patch("outside.py"), None)


def test_folder_without_a_repository_is_the_project(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    folder = tmp_path.resolve() / "plain"
    folder.mkdir()
    (tmp_path / "node.py").write_text("")
    (folder / "node.py").write_text("")
    monkeypatch.chdir(folder)
    assert located(patch("node.py"), None) == (folder, [folder / "node.py"])
    (folder / "node.py").unlink()
    with pytest.raises(RepairError, match="no such file"):
        located(patch("node.py"), None)


@pytest.mark.parametrize(
    ("names", "base"),
    [
        (("../secret.py",), "."),
        (("pkg/../../secret.py",), "."),
        (("secret.py",), ".."),
        (("pkg/params.yaml", "../secret.py"), "."),
        ((".git/config",), "."),
        (("config",), ".git"),
        (("link/secret.py",), "."),
    ],
)
def test_files_outside_the_project_are_refused(repository: Path, names: tuple[str, ...], base: str) -> None:
    repository_with_secret(repository)
    (repository / ".git" / "config").write_text("")
    (repository / "link").symlink_to(repository.parent)
    with pytest.raises(RefusedError, match="Nothing was changed"):
        located(patch(*names, root=repository, base=base), None)


def test_a_link_inside_the_project_is_followed(repository: Path) -> None:
    (repository / "link").symlink_to(repository / "pkg")
    found = located(patch("link/src/node.py", root=repository), None)
    assert found == (repository, [repository / "pkg" / "src" / "node.py"])


@pytest.mark.parametrize("name", ["a\0b", "a" * 5000])
def test_invalid_file_names_are_reported_in_one_sentence(repository: Path, name: str) -> None:
    with pytest.raises(RepairError, match=r"invalid file names|no such file"):
        located(patch(name, root=repository), None)
