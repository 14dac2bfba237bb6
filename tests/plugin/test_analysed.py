"""What is said of files that cannot be nodes."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from pytest_tarl.analysed import analysed
from pytest_tarl.errors import AnalysisError


def refused(folder: Path, *nodes: str) -> str:
    designation: Any = SimpleNamespace(nodes=nodes)
    with pytest.raises(AnalysisError) as caught:
        analysed(designation, folder, folder)
    return str(caught.value)


@pytest.mark.parametrize(
    "name", ["params.yaml", "params.yml", "robot.launch", "robot.launch.xml", "gains.json"]
)
def test_a_settings_file_among_the_nodes_is_told_how_parameters_reach_a_node(
    tmp_path: Path, name: str
) -> None:
    (tmp_path / "node.py").write_text("import rospy\n")
    (tmp_path / name).write_text("gain: 2.0\n")
    found = refused(tmp_path, "node.py", name)
    assert found.startswith(f"The marker names {name!r} among the nodes: it is not a Python file.")
    assert "parameters= of tarl.start" in found


def test_a_script_without_a_suffix_may_be_a_node(tmp_path: Path) -> None:
    (tmp_path / "node").write_text("import rospy\n")
    assert refused(tmp_path, "node").startswith(
        "No flow from a subscription to a publish call was found in node"
    )


def test_a_missing_file_comes_first(tmp_path: Path) -> None:
    assert refused(tmp_path, "params.yaml").startswith(
        "The marker names the node 'params.yaml': no such file in "
    )
