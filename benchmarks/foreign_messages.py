"""Messages as a new user would write them: every field has a value, and images, scans and clouds are complete."""

from __future__ import annotations

import math
import struct
from typing import Any

SOME = 3  # number of elements in arrays of variable length


def publish_to_all(tarl: Any, step: int) -> int:
    """Publish a message on every topic that a node subscribes to; return how many."""
    sent = 0
    for topic in tarl.bus.topics():
        kinds = [one.message_type for one in topic.subscriptions if one.message_type is not None]
        if kinds and topic.name not in ("/tf", "/tf_static", "/clock", "/rosout", "/parameter_events"):
            tarl.bus.publish(topic.name, filled(kinds[0], step))
            sent += 1
    return sent


def filled(kind: Any, step: int) -> Any:
    """Return a message of class `kind` whose values change slightly from step to step."""
    message = kind()
    _fill(message, step, 0)
    return message


def fields(message: Any) -> dict[str, str]:
    """Return a message's field types by name."""
    if hasattr(message, "_slot_types"):
        return dict(zip(message.__slots__, message._slot_types, strict=True))
    return dict(message.get_fields_and_field_types())


def _fill(message: Any, step: int, depth: int) -> None:
    own = _WHOLE.get(type(message).__name__)
    if own is not None:
        own(message, step)
    for name, kind in fields(message).items():
        value = getattr(message, name)
        if kind in ("string", "wstring") and not value:
            setattr(message, name, "base_link" if name.endswith("frame_id") else "something")
        elif kind in ("float32", "float64", "float", "double") and not value and own is None:
            setattr(message, name, 0.5 + 0.1 * math.sin(step))
        elif _is_array(kind) and len(value) == 0 and own is None:
            _fill_array(message, name, kind, step, depth)
        elif fields_of(value) and depth < 8:
            _fill(value, step, depth + 1)
    if type(message).__name__ == "Quaternion":
        message.x, message.y, message.z, message.w = 0.0, 0.0, math.sin(0.05), math.cos(0.05)


def fields_of(value: Any) -> bool:
    """Return whether a value is a message with fields to fill, which a time is not."""
    kind = type(value).__name__
    return (
        kind not in ("Time", "Duration")
        and hasattr(value, "__slots__")
        and (hasattr(value, "_slot_types") or hasattr(value, "get_fields_and_field_types"))
    )


def _is_array(kind: str) -> bool:
    return kind.endswith("[]") or kind.startswith("sequence<")


def _fill_array(message: Any, name: str, kind: str, step: int, depth: int) -> None:
    inner = kind.removesuffix("[]").removeprefix("sequence<").rstrip(">").partition(",")[0].strip()
    if inner in ("float32", "float64", "float", "double"):
        setattr(message, name, [0.5 + 0.1 * math.sin(step + number) for number in range(SOME)])
    elif inner == "string":
        setattr(message, name, [f"something_{number}" for number in range(SOME)])
    elif "/" in inner and "time" not in inner.lower() and depth < 4:
        from pytest_tarl.ros import message_type

        here = hasattr(message, "_slot_types")
        kind_of = message_type(inner if here or "/msg/" in inner else inner.replace("/", "/msg/"))
        setattr(message, name, [filled(kind_of, step + number) for number in range(SOME)])


def _image(message: Any, step: int) -> None:
    message.header.frame_id, message.height, message.width = "camera", 48, 64
    message.encoding, message.step = "bgr8", 192
    message.data = bytes((step + 5 * place) % 256 for place in range(48 * 192))


def _camera(message: Any, step: int) -> None:  # noqa: ARG001
    message.header.frame_id, message.height, message.width = "camera", 48, 64
    upper = hasattr(message, "K")
    values = {"K": [60.0, 0, 32, 0, 60, 24, 0, 0, 1], "R": [1.0, 0, 0, 0, 1, 0, 0, 0, 1],
              "P": [60.0, 0, 32, 0, 0, 60, 24, 0, 0, 0, 1, 0], "D": [0.0] * 5}  # fmt: skip
    for name, numbers in values.items():
        setattr(message, name if upper else name.lower(), [float(number) for number in numbers])
    message.distortion_model = "plumb_bob"


def _scan(message: Any, step: int) -> None:
    message.header.frame_id = "laser"
    message.angle_min, message.angle_max, message.angle_increment = -math.pi, math.pi, 2 * math.pi / 359
    message.range_min, message.range_max = 0.1, 10.0
    message.ranges = [1.0 + 0.5 * math.sin(0.1 * (step + beam)) for beam in range(360)]
    message.intensities = [1.0] * 360


def _cloud(message: Any, step: int) -> None:
    from pytest_tarl.ros import message_type

    field = message_type(
        "sensor_msgs/PointField" if hasattr(message, "_slot_types") else "sensor_msgs/msg/PointField"
    )
    message.header.frame_id, message.height, message.width, message.is_dense = "camera", 1, 10, True
    message.point_step, message.row_step = 12, 120
    message.fields = [_named(field(), name, 4 * place) for place, name in enumerate("xyz")]
    message.data = b"".join(struct.pack("<fff", 0.1 * point, 0.1 * step, 1.0) for point in range(10))


def _named(field: Any, name: str, offset: int) -> Any:
    field.name, field.offset, field.datatype, field.count = name, offset, 7, 1
    return field


def _grid(message: Any, step: int) -> None:  # noqa: ARG001
    message.header.frame_id = "map"
    message.info.width, message.info.height, message.info.resolution = 20, 20, 0.1
    message.info.origin.orientation.w = 1.0
    message.data = [0] * 400


_WHOLE = {
    "Image": _image,
    "CameraInfo": _camera,
    "LaserScan": _scan,
    "PointCloud2": _cloud,
    "OccupancyGrid": _grid,
}
