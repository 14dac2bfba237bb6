"""All published versions are kept; the newest release is the default, and addresses of schemas never change."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from website.publish import publish


def built(folder: Path, words: str) -> Path:
    (folder / "schemas").mkdir(parents=True, exist_ok=True)
    (folder / "index.html").write_text(words)
    (folder / "schemas" / "result.schema.json").write_text(json.dumps({"title": words}))
    return folder


def test_newest_release_is_the_latest(tmp_path: Path) -> None:
    tree = tmp_path / "tree"
    tree.mkdir()
    for tag in ("dev", "v0.10.0", "v0.9.1", "dev"):
        publish(built(tmp_path / "site", tag), tree, tag)
    assert (tree / "latest" / "index.html").read_text() == "v0.10.0"
    assert json.loads((tree / "schemas" / "result.schema.json").read_text())["title"] == "v0.10.0"
    versions = json.loads((tree / "versions.json").read_text())
    assert [one["version"] for one in versions] == ["0.10.0", "0.9.1", "dev"]
    assert [one["version"] for one in versions if one["aliases"]] == ["0.10.0"]
    assert "latest/index.html" in (tree / "index.html").read_text()


def test_before_the_first_release_latest_is_the_development_version(tmp_path: Path) -> None:
    (tmp_path / "tree").mkdir()
    publish(built(tmp_path / "site", "dev"), tmp_path / "tree", "dev")
    assert (tmp_path / "tree" / "latest" / "index.html").read_text() == "dev"


def test_publishing_a_version_again_removes_its_old_pages(tmp_path: Path) -> None:
    tree = tmp_path / "tree"
    tree.mkdir()
    (built(tmp_path / "site", "one") / "gone.html").touch()
    publish(tmp_path / "site", tree, "v1.0.0")
    (tmp_path / "site" / "gone.html").unlink()
    publish(built(tmp_path / "site", "two"), tree, "v1.0.0")
    assert not list(tree.rglob("gone.html"))


@pytest.mark.parametrize("tag", ["latest", "schemas", "../up", "", ".git"])
def test_unusable_tag_is_refused(tmp_path: Path, tag: str) -> None:
    with pytest.raises(ValueError, match="cannot name a version"):
        publish(built(tmp_path / "site", "x"), tmp_path, tag)
