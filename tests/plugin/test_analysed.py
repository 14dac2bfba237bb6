"""The messages about files that cannot be nodes."""

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
def test_error_for_a_settings_file_explains_parameters(tmp_path: Path, name: str) -> None:
    (tmp_path / "node.py").write_text("import rospy\n")
    (tmp_path / name).write_text("gain: 2.0\n")
    found = refused(tmp_path, "node.py", name)
    assert found.startswith(f"nodes= contains {name!r}, which is not a Python file.")
    assert "parameters= of tarl.start" in found


def test_a_script_without_a_suffix_may_be_a_node(tmp_path: Path) -> None:
    (tmp_path / "node").write_text("import rospy\n")
    assert refused(tmp_path, "node").startswith(
        "No flow from a subscription to a publish call was found in node"
    )


def test_a_missing_file_is_reported_first(tmp_path: Path) -> None:
    assert refused(tmp_path, "params.yaml").startswith(
        "The marker names the node 'params.yaml': no such file in "
    )


NODE = """
import rospy
from std_msgs.msg import Float64
from .maths import scaled
def heard(message):
    pub.publish(Float64(scaled(message.data)))
pub = rospy.Publisher("out", Float64, queue_size=1)
def run():
    rospy.Subscriber("in", Float64, heard)
"""


def test_error_for_a_starter_program_says_which_files_to_name(tmp_path: Path) -> None:
    package = tmp_path / "src" / "robot"
    (package / "maths").mkdir(parents=True)
    texts = {
        "__init__": "",
        "node": NODE,
        "maths/__init__": "from .unused import X\ndef scaled(value):\n    return 2.0 * value\n",
        "maths/unused": "from . import scaled\nX = (\n",
        "main": "import rospy\nfrom robot import node\nrospy.init_node('n')\nnode.run()\nrospy.spin()\n",
    }
    for name, text in texts.items():
        (package / f"{name}.py").write_text(text)
    (tmp_path / "tests").mkdir()
    designation: Any = SimpleNamespace(nodes=("../src/robot/main.py",))
    with pytest.raises(AnalysisError) as caught:
        analysed(designation, tmp_path / "tests", tmp_path)
    files = '"../src/robot/node.py", "../src/robot/maths/__init__.py"'
    assert str(caught.value).endswith(f"files that are imported, so name these: nodes=[{files}].")
    named: Any = SimpleNamespace(nodes=("node.py", "maths/__init__.py"))
    assert analysed(named, package, tmp_path).flows
