"""The parameters that a test passes to nodes, as a mapping or as a YAML file."""

from __future__ import annotations

from pathlib import Path

import pytest

from pytest_tarl import Sensor
from pytest_tarl.episode import Tarl
from pytest_tarl.errors import SettingsError
from pytest_tarl.instrumentation.importhook import NodeImports
from pytest_tarl.instrumentation.recorder import Recorder
from pytest_tarl.parameter_files import parameters_of

ROS1 = """
import rospy
from std_msgs.msg import Float64
rospy.init_node("pilot")
out = rospy.Publisher("/out", Float64, queue_size=1)
out.publish(rospy.get_param("~pid")["gain"] * rospy.get_param("~scale", 1.0))
rospy.spin()
"""
ROS2 = """
import rclpy
from std_msgs.msg import Float64
rclpy.init()
node = rclpy.create_node("pilot")
gain = node.declare_parameter("pid.gain", 1.0).value * node.declare_parameter("scale", 1.0).value
node.create_publisher(Float64, "/out", 1).publish(Float64(data=gain))
rclpy.spin(node)
"""
FLAT = "pid: {gain: 3.0}\nscale: 0.5\n"
BY_NODE = "pilot:\n  ros__parameters:\n    pid: {gain: 3.0}\n    scale: 0.5\n"


def sent(folder: Path, program: str, **options: object) -> float:
    (folder / "test").mkdir(exist_ok=True)
    (folder / "pilot.py").write_text(program, "utf-8")
    recorder = Recorder()
    tarl = Tarl(7, (Sensor("wet"),), folder / "test", recorder, NodeImports(folder, {}, recorder.hook))
    try:
        tarl.start("../pilot.py", **options)  # type: ignore[arg-type]
        tarl.step(0.1)
        message = tarl.bus.latest("/out")
        assert message is not None
        return float(message.data)
    finally:
        tarl.close()


@pytest.mark.parametrize(("program", "text"), [(ROS1, FLAT), (ROS2, FLAT), (ROS2, BY_NODE)])
def test_node_gets_parameters_beside_the_test(tmp_path: Path, program: str, text: str) -> None:
    (tmp_path / "config.yaml").write_text(text, "utf-8")
    assert sent(tmp_path, program, parameters="../config.yaml") == 1.5
    assert sent(tmp_path, program, parameters=tmp_path / "config.yaml") == 1.5


def test_mapping_is_returned_unchanged(tmp_path: Path) -> None:
    values = {"gain": 2.0}
    assert parameters_of(values, tmp_path, "tarl.start") is values
    assert parameters_of(None, tmp_path, "tarl.start") == {}


@pytest.mark.parametrize("given", [["gain", 2.0], 3.0, b"config.yaml"])
def test_other_types_name_the_function(tmp_path: Path, given: object) -> None:
    with pytest.raises(
        SettingsError, match=r"tarl\.launch: parameters takes a mapping or the path of a YAML"
    ):
        parameters_of(given, tmp_path, "tarl.launch")  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"a: [1", "is not valid YAML"),
        (b"\xff\xfe\x00", "cannot read the parameter file"),
        (b"- 1\n- 2\n", "must contain a mapping"),
        (b"3: 4\n", "must contain a mapping"),
        (b"", "must contain a mapping"),
        (b"day: 2024-13-45\n", "is not valid YAML"),
        (b"[" * 5000, "is not valid YAML"),
        (b"a: !!python/object/apply:os.getcwd []\n", "is not valid YAML"),
    ],
)
def test_unusable_file_is_described_in_one_sentence(tmp_path: Path, content: bytes, message: str) -> None:
    (tmp_path / "config.yaml").write_bytes(content)
    with pytest.raises(SettingsError, match=message) as caught:
        parameters_of("config.yaml", tmp_path, "tarl.start")
    assert "\n" not in str(caught.value)


def test_missing_file_error_names_its_folder(tmp_path: Path) -> None:
    with pytest.raises(
        SettingsError, match=r"no parameter file .*nowhere\.yaml.*relative to the test's folder"
    ):
        parameters_of("nowhere.yaml", tmp_path, "tarl.start")
