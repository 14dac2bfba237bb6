"""`sensor_msgs.point_cloud2` (ROS 1) and `sensor_msgs_py.point_cloud2` (ROS 2): convert points to clouds and back."""

from __future__ import annotations

from collections import namedtuple
from collections.abc import Iterable, Iterator, Sequence
from importlib import import_module
from typing import Any

__all__ = ["create_cloud", "create_cloud_xyz32", "dtype_from_fields", "read_points", "read_points_list",
           "read_points_numpy"]  # fmt: skip

TYPES = {
    1: "i1",
    2: "u1",
    3: "i2",
    4: "u2",
    5: "i4",
    6: "u4",
    7: "f4",
    8: "f8",
}  # PointField.datatype → numpy


def dtype_from_fields(
    fields: Iterable[Any], point_step: int | None = None, is_bigendian: bool = False
) -> Any:
    """Return the numpy type of one point."""
    import numpy as np

    order = ">" if is_bigendian else "<"
    names, formats, offsets = [], [], []
    for field in fields:
        names.append(field.name)
        base = order + TYPES[field.datatype]
        formats.append(base if field.count in (0, 1) else (base, (field.count,)))
        offsets.append(field.offset)
    layout: dict[str, Any] = {"names": names, "formats": formats, "offsets": offsets}
    if point_step is not None:
        layout["itemsize"] = point_step
    kind: Any = np.dtype
    return kind(layout)


def _structured(cloud: Any, names: Sequence[str] | None, skip_nans: bool, uvs: Any) -> Any:
    """Return the points as a structured array.

    `uvs` selects points. In ROS 1, it has their columns and rows; if it is empty, all points are selected. In ROS 2, it
    has their indices, counted without points that have NaN; in a dense cloud, no point is checked for NaN.
    """
    import numpy as np

    kind = dtype_from_fields(cloud.fields, cloud.point_step, cloud.is_bigendian)
    rows = np.frombuffer(bytes(cloud.data), dtype=np.uint8).reshape(cloud.height, cloud.row_step)
    used = np.ascontiguousarray(rows[:, : cloud.width * cloud.point_step])
    points = np.frombuffer(used.tobytes(), dtype=kind)
    chosen, ros1 = None if uvs is None else list(uvs), _is_ros1(cloud)
    if ros1 and chosen:
        points = points[[int(v) * cloud.width + int(u) for u, v in chosen]]
    if names is not None:
        missing = set(names) - set(points.dtype.names)
        if missing:
            raise AssertionError(f"Requests field is not in the fields of the PointCloud! {sorted(missing)}")
        points = points[list(names)]
    if skip_nans and (ros1 or not cloud.is_dense):
        keep = np.ones(points.shape, dtype=bool)
        for name in points.dtype.names:
            if points.dtype[name].kind == "f":
                keep &= ~np.isnan(points[name])
        points = points[keep]
    return points if ros1 or chosen is None else points[np.array(chosen, dtype=int)]


def _is_ros1(message: Any) -> bool:
    return hasattr(type(message), "_slot_types")


def read_points(
    cloud: Any,
    field_names: Sequence[str] | None = None,
    skip_nans: bool = False,
    uvs: Any = None,
    reshape_organized_cloud: bool = False,
) -> Any:
    """Return the points: one tuple at a time in ROS 1, a structured array in ROS 2."""
    points = _structured(cloud, field_names, skip_nans, uvs)
    if _is_ros1(cloud):
        return _one_by_one(points)
    return (
        points.reshape(cloud.height, cloud.width) if reshape_organized_cloud and cloud.height > 1 else points
    )


def _one_by_one(points: Any) -> Iterator[tuple[Any, ...]]:
    yield from points.tolist()


def read_points_list(
    cloud: Any, field_names: Any = None, skip_nans: bool = False, uvs: Any = None
) -> list[Any]:
    """Return the points as a list of named tuples."""
    points = _structured(cloud, field_names, skip_nans, uvs)
    point = namedtuple("Point", points.dtype.names)  # type: ignore[misc]
    return [point._make(values) for values in points.tolist()]


def read_points_numpy(cloud: Any, field_names: Any = None, skip_nans: bool = False, uvs: Any = None) -> Any:
    """Return the points as a plain array of shape (points, fields).

    Raise AssertionError, as ROS does, unless all fields have the same type.
    """
    import numpy as np

    points = _structured(cloud, field_names, skip_nans, uvs)
    kinds = {points.dtype[name] for name in points.dtype.names}
    if len(kinds) != 1:
        raise AssertionError("All fields need to have the same datatype. Use `read_points()` otherwise.")
    return np.stack([points[name] for name in points.dtype.names], axis=-1)


def create_cloud(header: Any, fields: Sequence[Any], points: Any) -> Any:
    """Return a cloud of points, given as tuples or as an array."""
    import numpy as np

    kind = dtype_from_fields(fields)
    if hasattr(points, "dtype") and points.dtype.names is not None:
        packed = points.astype(kind).ravel()
    else:
        packed = np.array([tuple(point) for point in points], dtype=kind)
    cloud: Any = import_module("sensor_msgs.msg").PointCloud2()
    cloud.header, cloud.fields = header, list(fields)
    cloud.height, cloud.width = 1, len(packed)
    cloud.is_bigendian, cloud.is_dense = False, False
    cloud.point_step, cloud.row_step = kind.itemsize, kind.itemsize * len(packed)
    cloud.data = packed.tobytes()
    return cloud


def create_cloud_xyz32(header: Any, points: Any) -> Any:
    """Return a cloud of (x, y, z) as float32."""
    field: Any = import_module("sensor_msgs.msg").PointField
    fields = [field(name=name, offset=4 * i, datatype=7, count=1) for i, name in enumerate("xyz")]
    return create_cloud(header, fields, points)
