"""Topics of image_transport: transports of an image are topics below its name, and `republish` converts them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Final

from tarl_lint.files import shown
from tarl_lint.model import Span
from tarl_lint.system.model import Endpoint, Instance
from tarl_lint.workspace.launch_model import LaunchedNode
from tarl_lint.workspace.name_resolution import resolved
from tarl_lint.workspace.ros_arguments import plain

# type of an endpoint that a C++ program creates with image_transport
IMAGE: Final = "Image by image_transport"
CAMERA: Final = "Image and CameraInfo by image_transport"
RAW: Final = "raw"
COMPRESSED: Final = "compressed"  # transport of the plugin that is installed nearly everywhere
_REPUBLISH: Final = "image_transport/republish"
_COMPONENT: Final = "image_transport::Republisher"


def is_republisher(node: LaunchedNode) -> bool:
    """Return whether a node is `republish`, which publishes the images of `in` on `out` in another transport."""
    program = f"{node.package}/{node.executable}" == _REPUBLISH or node.executable == _COMPONENT
    return program or _nodelet(node) is not None


def republished(instance: Instance, *, ros2: bool) -> tuple[Endpoint, ...]:
    """Return the topics of `republish`, by absolute names."""
    node = instance.node
    words: Sequence[str] = plain(node.arguments, for_ros2=ros2)
    words = words if (nodelet := _nodelet(node)) is None else nodelet
    given = dict(enumerate(words))
    arriving = given.get(0) or _parameter(node, "in_transport") or RAW
    leaving = given.get(1) or _parameter(node, "out_transport")
    span = Span(shown(node.file), max(node.line, 1), 1, max(node.line, 1), 2)
    if not leaving:
        sent = [_topic(instance, "out", one) for one in (RAW, COMPRESSED)]
    elif (
        ros2 and leaving != RAW
    ):  # the plugin creates the topic itself, so remapping `out` does not rename it
        sent = [instance.resolve(f"out/{leaving}")]
    else:
        sent = [_topic(instance, "out", leaving)]
    return (
        Endpoint("subscribes", (_topic(instance, "in", arriving),), "", span),
        *(Endpoint("publishes", (one,), "", span) for one in sent),
    )


def transported(instance: Instance, seen: Sequence[Endpoint]) -> Iterator[Endpoint]:
    """Yield the topics that a C++ program names, and the topics of the transports of its images."""
    for end in seen:
        base = end.names[0]
        if end.type not in (IMAGE, CAMERA):
            yield end
            continue
        names = [_topic(instance, base, RAW)]
        if end.role == "publishes":
            names.append(_topic(instance, base, COMPRESSED))
        else:
            names = [_topic(instance, base, _parameter(instance.node, "image_transport") or RAW)]
        if end.type == CAMERA:  # the camera_info topic is in the namespace of the image topic
            names.append(f"{instance.resolve(base).rpartition('/')[0]}/camera_info")
        for name in names:
            yield Endpoint(end.role, (name,), "", end.span)


def _topic(instance: Instance, base: str, transport: str) -> str:
    """Return the topic of a transport: it is below the image's topic, unless a remapping renames it."""
    if transport == RAW:
        return instance.resolve(base)
    own, name = instance.name.rpartition("/")[2], f"{base}/{transport}"
    renamed = instance.resolve(name)
    is_renamed = renamed != resolved(name, instance.node.namespace, own)
    return renamed if is_renamed else f"{instance.resolve(base)}/{transport}"


def _nodelet(node: LaunchedNode) -> tuple[str, ...] | None:
    """Return the arguments of the nodelet `republish`; None if the node is not one."""
    words = plain(node.arguments, for_ros2=False) if node.package == "nodelet" else ()
    if words[1:2] != (_REPUBLISH,) or words[0] not in ("load", "standalone"):
        return None
    return tuple(words[3 if words[0] == "load" else 2 :])


def _parameter(node: LaunchedNode, name: str) -> str:
    """Return the text of a private parameter that the launch file sets directly; "" if there is none."""
    found = [one for one in node.settings if one.name == f"~{name}" and not one.unknown]
    value = found[-1].value if found and found[-1].value is not None else found[-1].yaml if found else None
    return value if isinstance(value, str) and "$(" not in value else ""
