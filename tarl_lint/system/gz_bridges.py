"""Topics of the bridges between ROS 2 and Gazebo, from their arguments or from their YAML file.

`parameter_bridge` has arguments such as `/scan@sensor_msgs/msg/LaserScan[gz.msgs.LaserScan`: `[` is from Gazebo to
ROS, `]` from ROS to Gazebo, and `@` both. The parameter `config_file` names a YAML file with the same content. Source:
`parameter_bridge.cpp` and `bridge_config.cpp` of ros_gz_bridge, `image_bridge.cpp` of ros_gz_image.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any, Final

from tarl_lint.system.image_transport import IMAGE, transported
from tarl_lint.system.model import Endpoint, Instance, Role, Seen, place_of
from tarl_lint.workspace.bounded_files import UnreadableError, read_text
from tarl_lint.workspace.launch_model import LaunchedNode, Setting
from tarl_lint.workspace.model import Workspace
from tarl_lint.workspace.parameter_yaml import NoYamlError, content
from tarl_lint.workspace.ros_arguments import plain

LARGEST: Final = 1_000_000  # maximum size of a file (bytes)
_BRIDGES: Final = frozenset(
    f"{package}/{program}"
    for package in ("ros_gz_bridge", "ros_ign_bridge")
    for program in ("parameter_bridge", "bridge_node", "ros_gz_bridge::RosGzBridge")
)
_IMAGES: Final = frozenset(["ros_gz_image/image_bridge", "ros_ign_image/image_bridge"])
_OWN_NAMES: Final[Mapping[str, str]] = {
    "ros_gz_bridge/parameter_bridge": "ros_gz_bridge",
    "ros_gz_bridge/bridge_node": "ros_gz_bridge",
    "ros_gz_image/image_bridge": "ros_gz_image",
}
_ROLES: Final[Mapping[str, tuple[Role, ...]]] = {
    "@": ("subscribes", "publishes"), "[": ("publishes",), "]": ("subscribes",),
    "BIDIRECTIONAL": ("subscribes", "publishes"), "GZ_TO_ROS": ("publishes",), "ROS_TO_GZ": ("subscribes",),
}  # fmt: skip


def own_name(node: LaunchedNode) -> str:
    """Return the default name of a bridge; "" for other programs."""
    return _OWN_NAMES.get(f"{node.package}/{node.executable}", "")


def bridged(instance: Instance, values: Mapping[str, Any], workspace: Workspace) -> Seen | None:
    """Return the topics and services of a bridge with parameters `values`, or None."""
    identity = f"{instance.node.package}/{instance.node.executable}"
    words = plain(instance.node.arguments, for_ros2=True)
    if identity in _IMAGES:
        images = [
            Endpoint("publishes", (one,), IMAGE, place_of(instance)) for one in words if "$(" not in one
        ]
        return Seen(tuple(transported(instance, images)), through=False)
    if identity not in _BRIDGES:
        return None
    arguments = [_of_argument(text, instance) for text in words]
    entries = _entries(values.get("config_file"), workspace)
    ends = [end for found in arguments for end in found or ()]
    ends += [end for entry in entries or () for end in _of_entry(entry, instance)]
    certain = bool(ends) and None not in arguments and entries is not None
    return Seen(tuple(ends), certain, through=False)


def _of_argument(text: str, instance: Instance) -> list[Endpoint] | None:
    """Return the ends of one argument; None if they are not known.

    The argument is split as in `parameter_bridge.cpp`.
    """
    name, _, rest = text.partition("@")
    if "$(" in text or not name or not rest:
        return None
    sign = next((one for one in "@[]" if rest.find(one) > 0), "")
    kind, _, other = rest.partition(sign) if sign else (rest, "", "")
    if "/srv/" in kind:
        return [_end("serves", name, kind, instance)]
    if not sign or not other or "@" in other:
        return None  # the bridge refuses to start with such an argument
    return [_end(role, name, kind, instance) for role in _ROLES[sign]]


def _entries(path: Any, workspace: Workspace) -> list[Any] | None:
    """Return the entries of a bridge's YAML file; [] without a file, None if it is unknown."""
    if path is None or path == "":
        return []
    if not isinstance(path, str) or "$(" in path or not Path(path).is_relative_to(workspace.root):
        return None
    try:
        found = content(Setting("", Path(path), yaml=read_text(Path(path), LARGEST)))
    except (UnreadableError, NoYamlError):
        return None
    return found if isinstance(found, list) else []


def _of_entry(entry: Any, instance: Instance) -> Iterator[Endpoint]:
    """Yield the ends of a YAML entry; none for an invalid entry."""
    if not isinstance(entry, dict):
        return
    both, ros, gazebo = (
        str(entry.get(key) or "") for key in ("topic_name", "ros_topic_name", "gz_topic_name")
    )
    gazebo = gazebo or str(entry.get("ign_topic_name") or "")
    kind, direction = str(entry.get("ros_type_name") or ""), entry.get("direction", "BIDIRECTIONAL")
    name = both or ros or gazebo
    if not name or not kind or (both and (ros or gazebo)):
        return
    for role in _ROLES.get(str(direction), ()):
        yield _end(role, name, kind, instance)


def _end(role: Role, name: str, kind: str, instance: Instance) -> Endpoint:
    package, _, last = kind.partition("/")
    last = last.rpartition("/")[2]
    return Endpoint(role, (name,), last, place_of(instance), whole_type=f"{package}/{last}" if last else "")
