"""Nodes that project scans and move clouds. Points and fields are those of laser_geometry 1.6.7 on a real ROS 1."""

from __future__ import annotations

import math
from typing import Any

import pytest

from pytest_tarl.ros import angles
from tests.plugin.ros.conftest import Start

HEADS = {"rospy": "import rospy", "rclpy": "import rclpy"}
SCAN = """
import math
from laser_geometry import LaserProjection
from geometry_msgs.msg import TransformStamped
from sensor_msgs.msg import LaserScan
from tf2_sensor_msgs import do_transform_cloud
scan = LaserScan(angle_min=-0.5, angle_max=0.5, angle_increment=0.25, time_increment=0.01, range_min=0.2, range_max=5.0,
                 ranges=[1.0, 0.1, 2.0, float("inf"), 5.0], intensities=[10.0, 20.0, 30.0, 40.0, 50.0])
scan.header.frame_id = "laser"
cloud = LaserProjection().projectLaser(scan)
near = LaserProjection().projectLaser(scan, 1.5, 0x1F)
transform = TransformStamped()
transform.header.frame_id = "base"
transform.transform.translation.x = 1.0
transform.transform.rotation.z, transform.transform.rotation.w = math.sin(0.5), math.cos(0.5)
moved = do_transform_cloud(cloud, transform)
"""
IMPORTS = {
    "rospy": "from sensor_msgs.point_cloud2 import read_points_list",
    "rclpy": "from sensor_msgs_py.point_cloud2 import read_points_list",
}


@pytest.mark.parametrize("kind", ["rospy", "rclpy"])
def test_a_scan_becomes_a_cloud_that_can_be_moved(kind: str, start: Start) -> None:
    code = f"{HEADS[kind]}\n{IMPORTS[kind]}\n{SCAN}\nresults = [read_points_list(one) for one in (cloud, near, moved)]"
    names: dict[str, Any] = start(code).namespace  # type: ignore[attr-defined]
    cloud, near, moved = names["results"]
    assert [tuple(point) for point in cloud] == [
        pytest.approx((0.877583, -0.479426, 0, 10, 0), abs=1e-6), pytest.approx((2, 0, 0, 30, 2))
    ]  # fmt: skip
    assert [tuple(point) for point in near] == [
        pytest.approx((0.877583, -0.479426, 0, 10, 0, 1, 0, 0, 0, 0), abs=1e-6)
    ]
    assert [tuple(point) for point in moved] == [
        pytest.approx((1.877583, 0.479426, 0, 10, 0), abs=1e-6), pytest.approx((2.080605, 1.682942, 0, 30, 2), abs=1e-6)
    ]  # fmt: skip
    assert (names["cloud"].header.frame_id, names["moved"].header.frame_id) == ("laser", "base")
    fields = [(field.name, field.offset, field.datatype) for field in names["near"].fields]
    assert fields[:5] == [("x", 0, 7), ("y", 4, 7), ("z", 8, 7), ("intensity", 12, 7), ("index", 16, 5)]
    assert [name for name, _, _ in fields[5:]] == ["distances", "stamps", "vp_x", "vp_y", "vp_z"]


def test_a_buffer_transforms_clouds(start: Start) -> None:
    code = HEADS["rospy"] + SCAN + """
import tf2_ros
rospy.init_node("mapper")
buffer = tf2_ros.Buffer()
transform.child_frame_id = "laser"
buffer.set_transform(transform, "test")
again = buffer.transform(cloud, "base")
"""  # fmt: skip
    names: dict[str, Any] = start(code).namespace  # type: ignore[attr-defined]
    assert names["again"].data == names["moved"].data


@pytest.mark.parametrize(
    ("angle", "signed", "positive", "complement"),
    [
        (0.5, 0.5, 0.5, 0.5 - 2 * math.pi),
        (-0.5, -0.5, 2 * math.pi - 0.5, 2 * math.pi - 0.5),
        (7.0, 7 - 2 * math.pi, 7 - 2 * math.pi, 7 - 4 * math.pi),
        (0.0, 0.0, 0.0, 2 * math.pi),
    ],
)
def test_angles_are_normalized(angle: float, signed: float, positive: float, complement: float) -> None:
    assert angles.normalize_angle(angle) == pytest.approx(signed)
    assert angles.normalize_angle_positive(angle) == pytest.approx(positive)
    assert angles.two_pi_complement(angle) == pytest.approx(complement)
    assert angles.shortest_angular_distance(1.0, 1.0 + angle) == pytest.approx(signed)
