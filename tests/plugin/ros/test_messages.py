from __future__ import annotations

import copy
import pickle
import subprocess
import sys
from array import array
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pytest_tarl.errors import UnsupportedApiError
from pytest_tarl.extras import install_command
from pytest_tarl.ros import message_type
from pytest_tarl.ros.messages import find_class, snapshot
from pytest_tarl.ros.messages.definitions import find_message, parse, type_names
from pytest_tarl.ros.messages.installed import installed_kind
from pytest_tarl.ros.messages.snapshot import field_names, translate
from pytest_tarl.ros.messages.values import FieldError

PACKAGES = ("std_msgs", "geometry_msgs", "nav_msgs", "sensor_msgs", "visualization_msgs", "diagnostic_msgs")


def in_rosidl_range(number: float) -> bool:
    return not 3.402823466e38 < abs(number) < float("inf")


def test_form_of_the_type_name_selects_the_generation() -> None:
    assert field_names(message_type("std_msgs/Header")) == ("seq", "stamp", "frame_id")
    assert field_names(message_type("std_msgs/msg/Header")) == ("stamp", "frame_id")
    assert message_type("nav_msgs/Odometry") is message_type("nav_msgs/Odometry")


@given(st.lists(st.lists(st.sampled_from([0.0, -0.0, 1.0, 1, float("nan"), 0.1]), min_size=36, max_size=36)))
def test_covariances_arrive_bitwise_equal_after_any_earlier_message(sent: list[list[float]]) -> None:
    message = message_type("geometry_msgs/PoseWithCovariance")()
    for covariance in sent:
        message.covariance = list(covariance)
        arrived = snapshot.snapshot(message).covariance
        assert isinstance(arrived, tuple)
        assert [float(number).hex() for number in arrived] == [float(number).hex() for number in covariance]


def test_errors_name_unknown_types_and_invalid_names() -> None:
    with pytest.raises(UnsupportedApiError, match="nav_msgs/Odometri is not known here"):
        message_type("nav_msgs/Odometri")
    with pytest.raises(UnsupportedApiError, match="is not the name of a message type"):
        message_type("Odometry")


@pytest.mark.parametrize("kind", ["ros1", "ros2"])
def test_every_common_message_can_be_built_copied_and_printed(kind: str) -> None:
    for package in PACKAGES:
        for name in type_names(kind, package, "msg"):  # type: ignore[arg-type]
            made = find_class(kind, package, name)()  # type: ignore[arg-type, misc]
            twin = snapshot.snapshot(made)
            assert twin is not made
            assert snapshot.snapshot(twin) == twin
            assert repr(twin) == repr(snapshot.snapshot(twin))
            assert pickle.loads(pickle.dumps(twin)) == twin


@pytest.mark.parametrize(
    "part",
    ["srv.SetBool.Request", "srv.SetBool.Response", "action.Fibonacci.Goal", "action.Fibonacci.Feedback"],
)
def test_parts_of_services_and_actions_can_be_pickled(part: str) -> None:
    kind, name, half = part.split(".")
    package = "std_srvs" if kind == "srv" else "action_tutorials_interfaces"
    made = getattr(message_type(f"{package}/{kind}/{name}"), half)()
    assert pickle.loads(pickle.dumps(made)) == made


def test_ros1_constructor_takes_all_by_position_or_any_by_keyword() -> None:
    vector = message_type("geometry_msgs/Vector3")
    assert vector(1.0, 2.0, 3.0) == vector(x=1.0, y=2.0, z=3.0)
    assert vector(y=2.0).x == 0.0
    with pytest.raises(TypeError, match="Invalid number of arguments"):
        vector(1.0)
    with pytest.raises(AttributeError, match="speed is not an attribute of Vector3"):
        vector(speed=1.0)
    with pytest.raises(AttributeError):
        vector().speed = 1.0  # type: ignore[attr-defined]


CHECKSUMS = [  # as genpy generated them
    ("std_msgs/Empty", "d41d8cd98f00b204e9800998ecf8427e"),
    ("std_msgs/Header", "2176decaecbce78abc3b96ef049fabed"),
    ("std_msgs/Byte", "ad736a2e8818154c487bb80fe42ce43b"),
    ("sensor_msgs/LaserScan", "90c7ef2dc6895d81024acba2ac42f369"),
    ("sensor_msgs/BatteryState", "4ddae7f048e32fda22cac764685e3974"),
    ("nav_msgs/Odometry", "cd5e73d190d741a2f92e81eda573aca7"),
    ("nav_msgs/GetMapAction", "e611ad23fbf237c031b7536416dc7cd7"),
]


@pytest.mark.parametrize(("name", "checksum"), CHECKSUMS)
def test_ros1_messages_have_the_checksums_of_the_real_ones(name: str, checksum: str) -> None:
    assert find_class("ros1", *name.split("/"))._md5sum == checksum  # type: ignore[union-attr]


def test_ros1_message_shows_as_rostopic_does() -> None:
    header = message_type("std_msgs/Header")(frame_id="map")
    assert str(header) == 'seq: 0\nstamp: \n  secs: 0\n  nsecs:         0\nframe_id: "map"'


def test_ros2_constructor_takes_keywords_only_and_checks_types() -> None:
    vector = message_type("geometry_msgs/msg/Vector3")
    assert repr(vector(y=2.0)) == "geometry_msgs.msg.Vector3(x=0.0, y=2.0, z=0.0)"
    with pytest.raises(TypeError):
        vector(1.0)
    with pytest.raises(AssertionError, match="Invalid arguments passed to constructor: speed"):
        vector(speed=1.0)
    with pytest.raises(AssertionError, match="'x' field must be of type 'float'"):
        vector(x=1)
    with pytest.raises(AssertionError, match=r"integer in \[0, 255\]"):
        message_type("std_msgs/msg/UInt8")(data=256)


def test_ros2_defaults_constants_and_field_types_are_those_of_the_definitions() -> None:
    assert message_type("geometry_msgs/msg/Quaternion")().w == 1.0
    assert message_type("geometry_msgs/Quaternion")().w == 0.0
    assert message_type("sensor_msgs/msg/BatteryState").POWER_SUPPLY_STATUS_FULL == 4
    assert message_type("nav_msgs/msg/Odometry").get_fields_and_field_types()["child_frame_id"] == "string"


def test_ros2_arrays_are_packed_and_sized() -> None:
    scan = message_type("sensor_msgs/msg/LaserScan")()
    scan.ranges = [1.0, 2.0]
    assert scan.ranges == array("f", [1.0, 2.0])
    with pytest.raises(AssertionError):
        scan.ranges = [1]
    pose = message_type("geometry_msgs/msg/PoseWithCovariance")()
    pose.covariance = [float(number) for number in range(36)]
    assert isinstance(pose.covariance, np.ndarray)
    assert pose.covariance[35] == 35.0
    with pytest.raises(AssertionError, match="36 elements"):
        pose.covariance = [0.0]


def test_ros1_arrays_arrive_as_tuples_and_bytes() -> None:
    scan = snapshot.snapshot(message_type("sensor_msgs/LaserScan")(ranges=[1, 2.5], intensities=np.zeros(2)))
    assert (scan.ranges, scan.intensities) == ((1.0, 2.5), (0.0, 0.0))
    image = snapshot.snapshot(message_type("sensor_msgs/Image")(data=[0, 255]))
    assert image.data == b"\x00\xff"


@pytest.mark.parametrize(
    ("name", "fields", "said"),
    [
        ("std_msgs/Float64", {"data": "1.0"}, "must be a number"),
        ("std_msgs/Int8", {"data": 128}, "must lie within int8"),
        ("std_msgs/Int8", {"data": 1.0}, "must be an integer"),
        ("std_msgs/String", {"data": 5}, "must be a text"),
        ("std_msgs/Bool", {"data": 0.5}, "must be a bool"),
        ("geometry_msgs/Twist", {"linear": 1.0}, "must be of type geometry_msgs/Vector3, not float"),
        ("geometry_msgs/PoseWithCovariance", {"covariance": [0.0]}, "must hold 36 values, not 1"),
        ("std_msgs/Header", {"stamp": 5.0}, "must be a Time"),
    ],
)
def test_values_that_ros1_cannot_send_are_refused(name: str, fields: dict[str, object], said: str) -> None:
    with pytest.raises(FieldError, match=said):
        snapshot.snapshot(message_type(name)(**fields))


@given(st.floats(width=32).filter(in_rosidl_range), st.floats(allow_nan=False))
def test_float32_fields_are_rounded(single: float, double: float) -> None:
    for name in ("std_msgs/Float32", "std_msgs/msg/Float32"):
        sent = snapshot.snapshot(message_type(name)(data=single)).data
        assert sent == single or (sent != sent and single != single)
    assert snapshot.snapshot(message_type("std_msgs/Float64")(data=double)).data == double


@given(
    st.lists(st.floats(width=32, allow_nan=False).filter(in_rosidl_range), max_size=5),
    st.integers(0, 2**31 - 1),
    st.text(max_size=5),
)
def test_translation_to_the_other_generation_and_back_changes_nothing(
    ranges: list[float], seconds: int, frame: str
) -> None:
    old, new = message_type("sensor_msgs/LaserScan"), message_type("sensor_msgs/msg/LaserScan")
    scan = old(ranges=ranges)
    scan.header.stamp.secs, scan.header.frame_id = seconds, frame
    assert translate(translate(scan, new), old) == snapshot.snapshot(scan)


def test_nested_message_lists_are_translated_and_copied_deeply() -> None:
    path = message_type("nav_msgs/Path")(poses=[message_type("geometry_msgs/PoseStamped")()])
    path.poses[0].pose.position.x = 4.0
    newer = translate(path, message_type("nav_msgs/msg/Path"))
    twin = copy.deepcopy(newer)
    newer.poses[0].pose.position.x = 5.0
    assert (twin.poses[0].pose.position.x, path.poses[0].pose.position.x) == (4.0, 4.0)


def test_message_files_are_read_with_defaults_constants_and_arrays() -> None:
    read = parse(
        "ros2",
        "robot_msgs",
        "Wheel",
        """
        # a wheel
        uint8 LEFT=0
        string NAME = wheel   # text
        Header header
        float32[4] speeds
        Spoke[] spokes
        float64 radius 0.25
    """,
    )
    assert [(field.name, field.text) for field in read.fields] == [
        ("header", "std_msgs/Header"),
        ("speeds", "float32[4]"),
        ("spokes", "robot_msgs/Spoke[]"),
        ("radius", "float64"),
    ]
    assert read.fields[3].default == 0.25
    assert [(constant.name, constant.value) for constant in read.constants] == [
        ("LEFT", 0),
        ("NAME", "wheel"),
    ]


def test_definitions_missing_in_rosbags_are_known() -> None:
    assert field_names(message_type("turtlesim/Pose"))[:3] == ("x", "y", "theta")
    assert message_type("std_srvs/srv/SetBool").Request(data=True).data is True
    assert find_message("ros1", "nowhere_msgs", "Nothing") is None


def test_generation_of_an_installed_package_is_recognised_by_its_files(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for package, file in (("old_msgs", "_Twist.py"), ("new_msgs", "_twist.py")):
        (tmp_path / package / "msg").mkdir(parents=True)
        (tmp_path / package / "__init__.py").touch()
        (tmp_path / package / "msg" / file).touch()
    monkeypatch.syspath_prepend(tmp_path)
    assert (installed_kind("old_msgs"), installed_kind("new_msgs"), installed_kind("no_msgs")) == (
        "ros1",
        "ros2",
        None,
    )


def test_classes_of_an_installed_ros_are_used(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "shop_msgs" / "msg").mkdir(parents=True)
    (tmp_path / "shop_msgs" / "__init__.py").touch()
    (tmp_path / "shop_msgs" / "msg" / "_Price.py").write_text("class Price:\n    _type = 'shop_msgs/Price'\n")
    (tmp_path / "shop_msgs" / "msg" / "__init__.py").write_text("from ._Price import *\n")
    monkeypatch.syspath_prepend(tmp_path)
    assert message_type("shop_msgs/Price").__module__ == "shop_msgs.msg._Price"


def test_error_on_missing_rosbags_names_the_install_command(tmp_path: Path) -> None:
    program = """
import sys
sys.modules["rosbags"] = None
from pytest_tarl.ros import message_type
try:
    message_type("std_msgs/String")
except Exception as error:
    print(type(error).__name__, error)
"""
    said = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True).stdout
    assert said.startswith("UnsupportedApiError")
    assert install_command("ros") in said


def test_importing_the_package_imports_nothing_heavy() -> None:
    program = (
        "import sys, pytest_tarl.ros; print(sorted({'greenlet', 'rosbags', 'numpy'} & set(sys.modules)))"
    )
    said = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True).stdout
    assert said.strip() == "[]"
