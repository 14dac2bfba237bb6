"""A package `arm` with files that launch files read."""

from __future__ import annotations

from pathlib import Path

import pytest

PART = '<launch><arg name="rate" default="5"/><node pkg="arm" type="part" name="part_$(arg rate)"/></launch>'


@pytest.fixture
def package(tmp_path: Path) -> Path:
    folder = tmp_path / "arm"
    folder.mkdir()
    (folder / "package.xml").write_text("<package><name>arm</name></package>")
    (folder / "part.launch").write_text(PART)
    (folder / "words.txt").write_text("some words\n")
    (folder / "arm.yaml").write_text("/**:\n  ros__parameters:\n    kp: 2.0\n")
    return folder
