"""What the drivers of sensors may offer: types, and words in the names of topics and services."""

from __future__ import annotations

import pytest

from tarl_lint.system.model import Seen
from tarl_lint.system.sensor_drivers import driver_types, driver_words, offered, sensors, unused_types


@pytest.mark.parametrize(
    ("package", "program", "kind", "other"),
    [
        ("sick_scan", "sick_generic_caller", "LaserScan", "PointStamped"),
        ("acme_lidar_driver", "node", "PointCloud2", "PoseStamped"),
        ("acme", "acme_camera_node", "Image", "JointState"),
        ("acme_gps", "node", "NavSatFix", "LaserScan"),
        ("acme_imu_driver", "imu_node", "Imu", "PoseArray"),
        ("acme_camera_imu", "node", "MagneticField", "Twist"),
    ],
)
def test_sensor_driver_uses_types_of_its_sensor(package, program, kind, other):
    types = driver_types(package, program) or ()
    assert kind in types
    assert other not in types


@pytest.mark.parametrize(
    ("package", "program"),
    [
        ("lidar_obstacle_detector", "detector"),
        ("laser_filters", "scan_to_scan_filter_chain"),
        ("camera_tracker", "node"),
        ("pointcloud_to_laserscan", "pointcloud_to_laserscan_node"),
        ("acme_robot_lidar", "node"),
        ("acme", "node"),
        ("scamera", "node"),
    ],
)
def test_program_beyond_a_sensor_driver_may_use_any_topic(package, program):
    assert sensors(package, program) == ()
    assert driver_types(package, program) is None
    assert driver_words(package, program) is None


def test_sensor_driver_publishes_no_commands():
    assert "Twist" in unused_types("acme_rfid", "node")
    assert "Twist" in unused_types("lidar_obstacle_detector", "detector")
    assert unused_types("lidar_servo", "node") == frozenset()


@pytest.mark.parametrize(
    ("name", "may"),
    [
        ("/scout/rear/scan", True), ("/scan_1", True), ("/scout/laser/pointCloud", True), ("/velodyne_points", True),
        ("/acme/points_raw", True), ("/scout/obstacles", False), ("/scout/release", False), ("/nearest_point", False),
        ("/scan_matched", False),
    ],
)  # fmt: skip
def test_sensor_driver_may_use_typical_names(name, may):
    words = driver_words("velodyne_driver", "velodyne_node")
    assert words is not None
    assert offered(name, words) is may


def test_sensor_driver_may_publish_topics_of_its_launch_file():
    lidar = Seen(kinds=driver_types("acme_lidar", ""), words=driver_words("acme_lidar", ""))
    assert not lidar.may_offer("Trigger", ("/scout/release",), ())
    assert lidar.may_offer("Trigger", ("/scout/release",), ("scan", "~/release"))
    assert not lidar.may_offer("Twist", ("/scout/scan",), ())
    assert Seen().may_offer("Twist", ("/scout/scan",), ())
