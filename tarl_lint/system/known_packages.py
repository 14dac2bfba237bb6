"""Message and service types of well-known packages, and the typed topics of some of their programs.

The packages are usually installed without source. The types show which topics an unread node may publish or
subscribe to: a laser driver does not publish velocities. Transforms, diagnostics, parameters and states of
lifecycle nodes are left out, since no rule examines them.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from typing import Any, Final

from tarl_lint.model import Span
from tarl_lint.name_words import words
from tarl_lint.system.model import Endpoint, Instance, Role, Seen, place_of
from tarl_lint.system.sensor_drivers import driver_types, driver_words, unused_types
from tarl_lint.workspace.launch_model import LaunchedNode
from tarl_lint.workspace.ros_arguments import plain

_CAMERA: Final = "Image CompressedImage CameraInfo Packet Empty SetBool SetCameraInfo"
_PICTURES: Final = f"{_CAMERA} PointCloud2 DisparityImage Trigger PoseStamped"
_SCANNER: Final = (
    "LaserScan MultiEchoLaserScan LaserEcho LaserFan PointCloud PointCloud2 Polygon PolygonStamped UInt16 Empty "
    "Trigger SetBool Status"
)
_INERTIAL: Final = "Imu MagneticField Vector3Stamped Vector3 Temperature Empty Trigger Bool"
_VELOCITY: Final = "Twist TwistStamped Joy Bool String Odometry Marker"
_POSES: Final = "PoseStamped PoseWithCovarianceStamped PoseArray PointStamped"
_MAPPING: Final = (
    f"LaserScan MultiEchoLaserScan PointCloud2 Odometry Imu OccupancyGrid MapMetaData Float64 String Path {_POSES} "
    "MarkerArray Marker NavSatFix Empty GetMap SetMap LoadMap SaveMap Trigger LandmarkList SubmapList "
    "InteractiveMarker InteractiveMarkerFeedback InteractiveMarkerUpdate SetBool ResetMapping Pause Clear ClearQueue "
    "Reset LoopClosure MergeMaps AddSubmap ToggleInteractive SerializePoseGraph DeserializePoseGraph HectorDebugInfo "
    "HectorIterData SubmapQuery TrajectoryQuery StartTrajectory FinishTrajectory WriteState GetTrajectoryStates "
    "ReadMetrics"
)
_NAVIGATION: Final = (
    f"{_MAPPING} Twist TwistStamped OccupancyGridUpdate Costmap CostmapUpdate VoxelGrid Range PointCloud Polygon "
    "PolygonStamped SpeedLimit BehaviorTreeLog CostmapFilterInfo Bool GetPlan ClearEntireCostmap GridCells "
    "ManageLifecycleNodes GetCostmap GetCost GetCosts IsPathValid ParticleCloud CollisionMonitorState "
    "CollisionDetectorState Toggle BatteryState MoveBaseActionGoal MoveBaseActionResult MoveBaseActionFeedback "
    "GoalStatusArray GoalID RecoveryStatus WaypointStatus"
)
_FUSION: Final = (
    "Odometry Imu NavSatFix PoseStamped PoseWithCovarianceStamped Twist TwistStamped TwistWithCovarianceStamped "
    "AccelWithCovarianceStamped SetPose Empty SetDatum ToLL ToLLArray FromLL FromLLArray ToggleFilterProcessing "
    "GetState SetUTMZone Trigger"
)
_CONTROL: Final = (
    "JointState DynamicJointState JointTrajectory JointTrajectoryControllerState FollowJointTrajectory "
    "GripperCommand ParallelGripperCommand Float64MultiArray Twist TwistStamped Odometry AckermannDriveStamped Imu "
    "WrenchStamped Wrench PoseStamped Range InterfacesValues MultiDOFCommand MultiDOFStateStamped PidState "
    "AdmittanceControllerState Trigger SetBool DiagnosticArray"
)
_MARKERS: Final = (
    f"{_CAMERA} PoseStamped PoseArray TransformStamped Vector3Stamped PointStamped Marker MarkerArray UInt32MultiArray "
    "Bool AlvarMarker AnalyzeSingleImage"
)
# package → types that its programs use
_PACKAGES: Final[Mapping[str, str]] = {
    **dict.fromkeys(("joy", "joy_linux"), "Joy JoyFeedback JoyFeedbackArray"),
    **dict.fromkeys(("teleop_twist_joy", "teleop_twist_keyboard", "twist_mux", "twist_stamper", "key_teleop",
                     "yocs_velocity_smoother", "yocs_cmd_vel_mux", "rqt_robot_steering"), _VELOCITY),
    **dict.fromkeys(("usb_cam", "v4l2_camera", "cv_camera", "gscam", "uvc_camera", "libuvc_camera", "camera_ros",
                     "image_publisher", "web_video_server", "camera1394", "openni_camera", "openni2_camera",
                     "astra_camera", "freenect_camera", "prosilica_camera"), f"{_CAMERA} PointCloud2 PollImage"),
    **dict.fromkeys(("image_proc", "depth_image_proc", "stereo_image_proc", "image_view", "image_rotate",
                     "image_transport", "depthimage_to_laserscan"), f"{_PICTURES} LaserScan"),
    "realsense2_camera": f"{_PICTURES} Imu Odometry Extrinsics IMUInfo Metadata RGBD DeviceInfo GridCells String",
    **dict.fromkeys(("urg_node", "urg_node2", "rplidar_ros", "sllidar_ros2", "ydlidar_ros", "ydlidar_ros2_driver",
                     "hls_lfcd_lds_driver", "ldlidar_stl_ros2", "laser_filters", "pointcloud_to_laserscan",
                     "hokuyo_node", "lms1xx", "sick_tim", "xv_11_laser_driver", "laser_assembler", "ira_laser_tools"),
                    f"{_SCANNER} AssembleScans AssembleScans2"),
    **dict.fromkeys(("velodyne_driver", "velodyne_pointcloud", "velodyne_laserscan"),
                    "VelodyneScan VelodynePacket PointCloud2 LaserScan"),
    "pcl_ros": "PointCloud2 PointIndices ModelCoefficients PolygonStamped Image",
    **dict.fromkeys(("imu_filter_madgwick", "imu_complementary_filter", "imu_transformer", "imu_calib"), _INERTIAL),
    "nmea_navsat_driver": "NavSatFix TwistStamped TimeReference QuaternionStamped Sentence",
    "robot_localization": _FUSION,
    **dict.fromkeys(("amcl", "map_server", "gmapping", "hector_mapping", "slam_toolbox", "cartographer_ros",
                     "slam_karto"), _MAPPING),
    "robot_pose_ekf": "Odometry Imu PoseWithCovarianceStamped GetStatus",
    "sound_play": "SoundRequest SoundRequestActionGoal SoundRequestActionFeedback SoundRequestActionResult",
    "move_base": _NAVIGATION,
    **dict.fromkeys(("nav2_amcl", "nav2_map_server", "nav2_controller", "nav2_planner", "nav2_behaviors",
                     "nav2_recoveries", "nav2_bt_navigator", "nav2_waypoint_follower", "nav2_velocity_smoother",
                     "nav2_smoother", "nav2_lifecycle_manager", "nav2_collision_monitor",
                     "nav2_costmap_2d", "nav2_bringup"), _NAVIGATION),
    "octomap_server": "PointCloud2 Octomap MarkerArray OccupancyGrid Empty GetOctomap BoundingBoxQuery",
    **dict.fromkeys(("apriltag_ros", "aruco_ros", "ar_track_alvar"),
                    f"{_MARKERS} AprilTagDetectionArray AlvarMarkers MarkerArray PointCloud2"),
    "turtlesim": "Twist Pose Color Empty Kill Spawn SetPen TeleportAbsolute TeleportRelative",
    # starts Gazebo, whose plugins may run the controllers of ros2_control
    "ros_gz_sim": _CONTROL,
    "rosapi": "",
    "tf2_web_republisher": "",
    # types that RViz's tools publish, without those that it displays
    **dict.fromkeys(("rviz", "rviz2"), "PoseStamped PoseWithCovarianceStamped PointStamped InteractiveMarkerFeedback"),
}  # fmt: skip
# programs without topics of the types that rules examine
_QUIET: Final = frozenset(
    ["nodelet/manager", "rqt_reconfigure/rqt_reconfigure", "gazebo_ros/spawn_model", "gazebo_ros/spawn_entity.py",
     "ros_gz_sim/create", "controller_manager/spawner", "controller_manager/unspawner", "rosbag/record",
     "diagnostic_aggregator/aggregator_node", "rqt_robot_monitor/rqt_robot_monitor", "rqt_tf_tree/rqt_tf_tree",
     "nav2_lifecycle_manager/lifecycle_manager"]
)  # fmt: skip

_Typed = tuple[str, str]
_SCAN: Final[_Typed] = ("", "scan:LaserScan")
_FILTERED: Final[_Typed] = ("", "odometry/filtered:Odometry")
# program → the subscribed and the published topics whose types are known
_TYPED: Final[Mapping[str, _Typed]] = {
    **dict.fromkeys(("joy/joy_node", "joy_linux/joy_linux_node"), ("", "joy:Joy")),
    "teleop_twist_joy/teleop_node": ("joy:Joy", "cmd_vel:Twist"),
    "teleop_twist_keyboard/teleop_twist_keyboard": ("", "cmd_vel:Twist"),
    "teleop_twist_keyboard/teleop_twist_keyboard.py": ("", "cmd_vel:Twist"),
    "twist_mux/twist_mux": ("", "cmd_vel_out:Twist"),
    "move_base/move_base": ("odom:Odometry", "cmd_vel:Twist"),
    **dict.fromkeys(("urg_node/urg_node", "urg_node/urg_node_driver", "rplidar_ros/rplidarNode",
                     "rplidar_ros/rplidar_node", "sllidar_ros2/sllidar_node"), _SCAN),
    "amcl/amcl": ("scan:LaserScan initialpose:PoseWithCovarianceStamped", "amcl_pose:PoseWithCovarianceStamped"),
    "map_server/map_server": ("", "map:OccupancyGrid"),
    **dict.fromkeys((f"robot_localization/{name}" for name in
                     ("ekf_node", "ukf_node", "ekf_localization_node", "ukf_localization_node")), _FILTERED),
    "usb_cam/usb_cam_node_exe": ("", "image_raw:Image camera_info:CameraInfo"),
    "usb_cam/usb_cam_node": ("", "~image_raw:Image ~camera_info:CameraInfo"),
    "v4l2_camera/v4l2_camera_node": ("", "image_raw:Image camera_info:CameraInfo"),
}  # fmt: skip
# packages without further velocity and joystick topics
_TOLD: Final = ("joy", "joy_linux", "teleop_twist_joy", "teleop_twist_keyboard", "move_base")
_TOLD_TYPES: Final = frozenset(["Twist", "TwistStamped", "Joy"])
# parameters with which a program publishes TwistStamped in place of Twist
_STAMPED: Final = ("use_stamped", "publish_stamped_twist", "stamped")
_UNSTAMPED: Final = "Twist"


def unlikely(node: LaunchedNode) -> frozenset[str]:
    """Return types that a program of an unknown package does not use: for example, sensor drivers send no commands."""
    return unused_types(*identity(node))


def name_words(node: LaunchedNode) -> frozenset[str] | None:
    """Return the words of the names that a program may give topics and services; None if it may use any words."""
    found = driver_words(*identity(node))
    return None if found is None else found | frozenset(words(node.name))


def kinds(node: LaunchedNode) -> frozenset[str] | None:
    """Return the types of messages and services that a program may use; None if it is unknown."""
    package, program = identity(node)
    if f"{package}/{program}" in _QUIET or node.kind == "container":
        return frozenset()
    found = of_package(package)
    told = package in _TOLD and f"{package}/{program}" in _TYPED
    if found is None:
        return driver_types(package, program)
    return found - _TOLD_TYPES if told else found


def started_by(package: str) -> Seen:
    """Return the known facts about the nodes that the launch files of a package start."""
    return Seen(kinds=of_package(package), never=unused_types(package, ""), words=driver_words(package, ""))


def of_package(package: str) -> frozenset[str] | None:
    """Return the types of messages and services that the programs of a package may use; None if they are unknown."""
    types = _PACKAGES.get(package)
    return driver_types(package, "") if types is None else frozenset(types.split())


def typed(instance: Instance, values: Mapping[str, Any], *, ros2: bool) -> Seen:
    """Return the topics with known types of a program. `values` are its parameters."""
    package, program = identity(instance.node)
    topics = _TYPED.get(f"{package}/{program}")
    if topics is None:
        return Seen()
    # twist_mux of ROS 2 uses TwistStamped by default since 4.4.0
    usual: object = None if ros2 and package == "twist_mux" else False
    stamped = next((values[one] for one in _STAMPED if one in values), usual)
    span = place_of(instance)
    ends = [*_ends("subscribes", topics[0], stamped, span), *_ends("publishes", topics[1], stamped, span)]
    if package != "twist_mux":
        return Seen(tuple(ends))
    inputs, locks = _multiplexed("topics", values), _multiplexed("locks", values)
    ends += [Endpoint("subscribes", (one,), _velocity(stamped), span) for one in inputs or ()]
    ends += [Endpoint("subscribes", (one,), "Bool", span) for one in locks or ()]
    return Seen(tuple(ends), certain=bool(inputs) and locks is not None)


def _ends(role: Role, topics: str, stamped: object, span: Span) -> Iterator[Endpoint]:
    for topic in topics.split():
        name, _, kind = topic.partition(":")
        yield Endpoint(role, (name,), _velocity(stamped) if kind == _UNSTAMPED else kind, span)


def _velocity(stamped: object) -> str:
    """Return the type of velocities; "" if it is known only on the robot."""
    return "TwistStamped" if stamped is True else _UNSTAMPED if stamped is False else ""


def _multiplexed(group: str, values: Mapping[str, Any]) -> list[str] | None:
    """Return the inputs of a multiplexer: in ROS 1 a list of mappings, in ROS 2 parameters `topics.NAME.topic`.

    Return None if one of them is not known.
    """
    rows = values.get(group, [])
    if not isinstance(rows, list):
        return None
    names = [row.get("topic") if isinstance(row, dict) else None for row in rows]
    names += [values[one] for one in sorted(values) if re.fullmatch(rf"{group}[./][^./]+[./]topic", one)]
    known = [one for one in names if isinstance(one, str) and one and "$(" not in one]
    return known if len(known) == len(names) else None


def identity(node: LaunchedNode) -> tuple[str, str]:
    """Return package and program; for a nodelet or component, the package of its class."""
    if node.package == "nodelet" and node.executable == "nodelet":
        words = plain(node.arguments, for_ros2=False)
        if words and words[0] == "manager":
            return "nodelet", "manager"
        package, _, name = (words[1] if len(words) > 1 else "").partition("/")
        return package, name
    if "::" in node.executable:
        package, _, name = node.executable.partition("::")
        return package, name
    return node.package, node.executable
