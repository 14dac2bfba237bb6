"""Topics of common programs, nodelets and components that are usually installed without their source.

The names are those in the sources of each package: `image_proc/src`, `depth_image_proc/src` and
`stereo_image_proc/src` of image_pipeline (1.17.0 for ROS 1, 30b982af for ROS 2), `pcl_ros/src/pcl_ros/filters` of
perception_pcl 1.7.5, `pointcloud_to_laserscan/src` (d71ed2e), `depthimage_to_laserscan/src` (a05f98d),
`imu_filter_madgwick/src` and `imu_complementary_filter/src` of imu_tools (4b8d5db), joint_state_publisher (7cb7069)
and robot_state_publisher (e0f77e6). If a launch file renames anything else, the table makes no claim.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any, Final

from tarl_lint.model import Span
from tarl_lint.system.image_transport import CAMERA, IMAGE, transported
from tarl_lint.system.model import Endpoint, Instance, Role, Seen, place_of
from tarl_lint.workspace.launch_model import LaunchedNode
from tarl_lint.workspace.ros_arguments import plain

# The subscribed and the published topics, each separated by spaces. `:` marks an image of image_transport; `@` marks
# an image of a camera, which also has the topic `camera_info`.
_Names = tuple[str, str]

_CLOUD: Final[_Names] = ("~input", "~output")
_CONVERT: Final[_Names] = (":image_raw", ":image")
_POINTS: Final[_Names] = ("@image_rect", "points")
_COLORED: Final = ":rgb/image_rect_color rgb/camera_info :depth_registered/image_rect"
_DISPARITY_OF_DEPTH: Final[_Names] = (":left/image_rect right/camera_info", "left/disparity")
_REGISTER: Final[_Names] = (
    ":depth/image_rect depth/camera_info rgb/camera_info",
    "@depth_registered/image_rect",
)
_SCAN_OF_DEPTH: Final[_Names] = ("@image", "scan")
_SCAN_OF_CLOUD: Final[_Names] = ("cloud_in", "scan")
_ORIENTATION: Final[_Names] = ("imu/data_raw imu/mag", "imu/data")

_ROS1: Final[Mapping[str, _Names]] = {
    "image_proc/debayer": (":image_raw", ":image_mono :image_color"),
    "image_proc/rectify": ("@image_mono", ":image_rect"),
    "image_proc/image_proc": (
        "@image_raw",
        ":image_mono :image_rect :image_color :image_rect_color",
    ),
    "image_proc/crop_decimate": (
        "@camera/image_raw",
        "@camera_out/image_raw",
    ),
    "image_proc/crop_non_zero": _CONVERT,
    "image_proc/resize": (":image camera_info", ":~image ~camera_info"),
    "depth_image_proc/convert_metric": _CONVERT,
    "depth_image_proc/crop_foremost": _CONVERT,
    "depth_image_proc/disparity": _DISPARITY_OF_DEPTH,
    "depth_image_proc/point_cloud_xyz": _POINTS,
    "depth_image_proc/point_cloud_xyz_radial": ("@image_raw", "points"),
    "depth_image_proc/point_cloud_xyzrgb": (_COLORED, "depth_registered/points"),
    "depth_image_proc/register": _REGISTER,
    "depthimage_to_laserscan/DepthImageToLaserScanNodelet": _SCAN_OF_DEPTH,
    "depthimage_to_laserscan/depthimage_to_laserscan": _SCAN_OF_DEPTH,
    "pointcloud_to_laserscan/pointcloud_to_laserscan_nodelet": _SCAN_OF_CLOUD,
    "pointcloud_to_laserscan/pointcloud_to_laserscan_node": _SCAN_OF_CLOUD,
    "imu_filter_madgwick/ImuFilterNodelet": _ORIENTATION,
    "imu_filter_madgwick/imu_filter_node": _ORIENTATION,
    "imu_complementary_filter/complementary_filter_node": _ORIENTATION,
    **dict.fromkeys(
        (f"pcl/{name}" for name in ("VoxelGrid", "PassThrough", "CropBox", "StatisticalOutlierRemoval",
                                    "RadiusOutlierRemoval")),
        _CLOUD,
    ),
}  # fmt: skip
# ROS 2 components: package, class, program with the same code
_COMPONENTS: Final[Mapping[tuple[str, str, str], _Names]] = {
    ("image_proc", "RectifyNode", "rectify_node"): ("@image", ":image_rect"),
    ("image_proc", "DebayerNode", "debayer_node"): (":image_raw", ":image_mono :image_color"),
    ("image_proc", "CropDecimateNode", "crop_decimate_node"): ("@in/image_raw", "@out/image_raw"),
    ("image_proc", "CropNonZeroNode", "crop_non_zero_node"): _CONVERT,
    ("image_proc", "ResizeNode", "resize_node"): ("@image/image_raw", "@resize/image_raw"),
    ("image_proc", "TrackMarkerNode", "track_marker_node"): ("@image", "tracked_pose"),
    ("depth_image_proc", "ConvertMetricNode", "convert_metric_node"): _CONVERT,
    ("depth_image_proc", "CropForemostNode", "crop_foremost_node"): _CONVERT,
    ("depth_image_proc", "DisparityNode", "disparity_node"): _DISPARITY_OF_DEPTH,
    ("depth_image_proc", "PointCloudXyzNode", "point_cloud_xyz_node"): _POINTS,
    ("depth_image_proc", "PointCloudXyzRadialNode", "point_cloud_xyz_radial_node"): (
        "@depth/image_raw",
        "points",
    ),
    ("depth_image_proc", "PointCloudXyzrgbNode", "point_cloud_xyzrgb_node"): (_COLORED, "points"),
    ("depth_image_proc", "RegisterNode", "register_node"): _REGISTER,
    ("pointcloud_to_laserscan", "PointCloudToLaserScanNode", "pointcloud_to_laserscan_node"): _SCAN_OF_CLOUD,
    ("pointcloud_to_laserscan", "LaserScanToPointCloudNode", "laserscan_to_pointcloud_node"): ("scan_in", "cloud"),
}  # fmt: skip
_ROS2: Final[Mapping[str, _Names]] = {
    name: topics
    for (package, kind, program), topics in _COMPONENTS.items()
    for name in (f"{package}::{kind}", f"{package}/{program}")
} | {
    "imu_filter_madgwick/imu_filter_madgwick_node": _ORIENTATION,
    "imu_complementary_filter/complementary_filter_node": _ORIENTATION,
}
_JOINTS: Final = ("joint_state_publisher", "joint_state_publisher_gui")
_LOADING: Final = ("load", "standalone")
_TRANSPORTED: Final[Mapping[str, str]] = {":": IMAGE, "@": CAMERA}


def stated(instance: Instance, values: Mapping[str, Any], *, ros2: bool) -> Seen:
    """Return the topics of a program with parameters `values`; empty if it is unknown."""
    joints = _of_joints(instance, values)
    if joints is not None:
        return joints
    topics = (_ROS2 if ros2 else _ROS1).get(_identity(instance.node, ros2=ros2))
    if topics is None:
        return Seen()
    subscribed, published = (text.split() for text in topics)
    if values.get("use_mag") is False:
        subscribed = [one for one in subscribed if one != "imu/mag"]
    names = {one.lstrip(":@") for one in (*subscribed, *published)}
    own = instance.node.remaps[instance.node.inherited :]
    if any(not _belongs(old, names) for old, _ in own):
        return Seen()
    span = place_of(instance)
    ends = [*_ends("subscribes", subscribed, span), *_ends("publishes", published, span)]
    return Seen(tuple(_plain(transported(instance, ends))))


def _of_joints(instance: Instance, values: Mapping[str, Any]) -> Seen | None:
    """Return the topics of joint state programs; None for others."""
    package, program = instance.node.package, instance.node.executable.removesuffix(".py")
    span = place_of(instance)
    if package == "robot_state_publisher":
        needed = "robot_state_publisher", "robot_state_publisher::RobotStatePublisher", "state_publisher"
        return (
            Seen((_joint("subscribes", "joint_states", span),), certain=True) if program in needed else None
        )
    if package not in _JOINTS or program not in _JOINTS:
        return None
    sources = values.get("source_list", [])
    known = isinstance(sources, list) and all(isinstance(one, str) and "$(" not in one for one in sources)
    read = [_joint("subscribes", one, span) for one in sources] if known else []
    return Seen((*read, _joint("publishes", "joint_states", span)), certain=known)


def _joint(role: Role, name: str, span: Span) -> Endpoint:
    return Endpoint(role, (name,), "JointState", span, whole_type="sensor_msgs/JointState")


def _ends(role: Role, names: Sequence[str], span: Span) -> Iterator[Endpoint]:
    for name in names:
        yield Endpoint(role, (name.lstrip(":@"),), _TRANSPORTED.get(name[0], ""), span)


def _plain(ends: Iterator[Endpoint]) -> Iterator[Endpoint]:
    """Yield endpoints without the pseudo-type of images."""
    for one in ends:
        yield Endpoint(one.role, one.names, "", one.span)


def _identity(node: LaunchedNode, *, ros2: bool) -> str:
    """Return `package/program`, `package/nodelet` or `package::Component`."""
    if node.package == "nodelet" and node.executable == "nodelet":
        words = plain(node.arguments, for_ros2=ros2)
        return words[1] if len(words) > 1 and words[0] in _LOADING else ""
    return node.executable if "::" in node.executable else f"{node.package}/{node.executable}"


def _belongs(old: str, names: set[str]) -> bool:
    """Return whether a renamed topic belongs to one of the names."""
    name = old.lstrip("/")
    parts = {name, name.rpartition("/")[0], name.replace("~/", "~")}
    return not parts.isdisjoint(names) or name.endswith("camera_info")
