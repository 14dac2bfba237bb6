"""Topics of common programs, nodelets and components that are usually installed without their source.

The names are those of each package's documentation. Where a launch file renames anything else, nothing is claimed.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Final

from tarl_lint.files import shown
from tarl_lint.model import Span
from tarl_lint.system.image_transport import CAMERA, IMAGE, transported
from tarl_lint.system.model import Endpoint, Instance, Role
from tarl_lint.workspace.launch_model import LaunchedNode
from tarl_lint.workspace.ros_arguments import plain

# The subscribed and the published topics, each separated by spaces. `:` marks an image of image_transport; `@` marks
# an image of a camera, which also has the topic `camera_info`.
_Names = tuple[str, str]

_CLOUD: Final[_Names] = ("~input", "~output")
_RECTIFY: Final[_Names] = ("@image", ":image_rect")
_POINTS: Final[_Names] = ("@image_rect", "points")
_COLORED: Final[_Names] = (
    ":rgb/image_rect_color rgb/camera_info :depth_registered/image_rect",
    "depth_registered/points",
)
_REGISTER: Final[_Names] = (
    ":depth/image_rect depth/camera_info rgb/camera_info",
    "@depth_registered/image_rect",
)
_SCAN_OF_DEPTH: Final[_Names] = ("@image", "scan")
_SCAN_OF_CLOUD: Final[_Names] = ("cloud_in", "scan")
_ORIENTATION: Final[_Names] = ("imu/data_raw imu/mag", "imu/data")

_PROGRAMS: Final[Mapping[str, _Names]] = {
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
    "image_proc::RectifyNode": _RECTIFY,
    "image_proc::DebayerNode": (":image_raw", ":image_mono :image_color"),
    "depth_image_proc/convert_metric": (":image_raw", ":image"),
    "depth_image_proc/point_cloud_xyz": _POINTS,
    "depth_image_proc/point_cloud_xyzrgb": _COLORED,
    "depth_image_proc/register": _REGISTER,
    "depth_image_proc::PointCloudXyzNode": _POINTS,
    "depth_image_proc::ConvertMetricNode": (":image_raw", ":image"),
    "depthimage_to_laserscan/DepthImageToLaserScanNodelet": _SCAN_OF_DEPTH,
    "depthimage_to_laserscan/depthimage_to_laserscan": _SCAN_OF_DEPTH,
    "pointcloud_to_laserscan/pointcloud_to_laserscan_nodelet": _SCAN_OF_CLOUD,
    "pointcloud_to_laserscan/pointcloud_to_laserscan_node": _SCAN_OF_CLOUD,
    "imu_filter_madgwick/ImuFilterNodelet": _ORIENTATION,
    "imu_filter_madgwick/imu_filter_node": _ORIENTATION,
    **dict.fromkeys(
        (f"pcl/{name}" for name in ("VoxelGrid", "PassThrough", "CropBox", "StatisticalOutlierRemoval")),
        _CLOUD,
    ),
}
_LOADING: Final = ("load", "standalone")
_TRANSPORTED: Final[Mapping[str, str]] = {":": IMAGE, "@": CAMERA}


def stated(instance: Instance, *, ros2: bool) -> tuple[Endpoint, ...]:
    """Return the topics that the documentation of a program states; empty for unknown programs."""
    topics = _PROGRAMS.get(_identity(instance.node, ros2=ros2))
    if topics is None:
        return ()
    subscribed, published = (text.split() for text in topics)
    names = {one.lstrip(":@") for one in (*subscribed, *published)}
    own = instance.node.remaps[instance.node.inherited :]
    if any(not _belongs(old, names) for old, _ in own):
        return ()
    span = Span(shown(instance.node.file), max(instance.node.line, 1), 1, max(instance.node.line, 1), 2)
    ends = [*_ends("subscribes", subscribed, span), *_ends("publishes", published, span)]
    return tuple(_plain(transported(instance, ends)))


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
    """Return whether a renamed topic is one of the names, or a transport or the camera of one."""
    name = old.lstrip("/")
    parts = {name, name.rpartition("/")[0], name.replace("~/", "~")}
    return not parts.isdisjoint(names) or name.endswith("camera_info")
