"""ros_numpy: convert geometry, images, maps and point clouds to numpy arrays and back."""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module
from typing import Any

from pytest_tarl.ros.cv_bridge import CvBridge
from pytest_tarl.ros.messages.snapshot import type_name
from pytest_tarl.ros.point_cloud2 import TYPES, dtype_from_fields
from pytest_tarl.ros.transformations_rigid import quaternion_from_matrix, quaternion_matrix

__all__ = [
    "array_to_pointcloud2", "get_xyz_points", "image_to_numpy", "msgify", "numpify", "numpy_to_image",
    "numpy_to_occupancy_grid", "occupancygrid_to_numpy", "pointcloud2_to_array", "pointcloud2_to_xyz_array",
    "split_rgb_field",
]  # fmt: skip

_KINDS = {kind: number for number, kind in TYPES.items()}  # numpy → PointField.datatype


def numpify(msg: Any, *args: Any, **kwargs: Any) -> Any:
    """Return a message as an array. Raise ValueError for an unsupported type."""
    convert = _TO_ARRAY.get(type_name(type(msg)))
    if convert is None:
        raise ValueError(
            f"Unable to convert message {type(msg).__name__} - only supports {', '.join(_TO_ARRAY)}"
        )
    return convert(msg, *args, **kwargs)


def msgify(msg_type: Any, numpy_obj: Any, *args: Any, **kwargs: Any) -> Any:
    """Return an array as a message of a type. Raise ValueError for an unsupported type."""
    convert = _FROM_ARRAY.get(type_name(msg_type))
    if convert is None:
        raise ValueError(
            f"Unable to build message {msg_type.__name__} - only supports {', '.join(_FROM_ARRAY)}"
        )
    return convert(msg_type, numpy_obj, *args, **kwargs)


def _parts(names: str, last: float) -> Callable[..., Any]:
    def convert(msg: Any, hom: bool = False) -> Any:
        import numpy as np

        return np.array([*(getattr(msg, name) for name in names), *([last] if hom else [])], dtype=float)

    return convert


def _from_parts(names: str) -> Callable[..., Any]:
    def convert(made: Any, array: Any) -> Any:
        return made(**{name: float(part) for name, part in zip(names, array, strict=False)})

    return convert


def _matrix(move: Any, turn: Any) -> Any:
    matrix = quaternion_matrix((turn.x, turn.y, turn.z, turn.w))
    matrix[:3, 3] = move.x, move.y, move.z
    return matrix


def _set_rigid(move: Any, turn: Any, matrix: Any) -> None:
    move.x, move.y, move.z = (float(part) for part in matrix[:3, 3])
    turn.x, turn.y, turn.z, turn.w = (float(part) for part in quaternion_from_matrix(matrix))


def _pose(made: Any, matrix: Any) -> Any:
    pose = made()
    _set_rigid(pose.position, pose.orientation, matrix)
    return pose


def _transform(made: Any, matrix: Any) -> Any:
    transform = made()
    _set_rigid(transform.translation, transform.rotation, matrix)
    return transform


def image_to_numpy(msg: Any) -> Any:
    """Return an image as an array of shape (height, width[, channels])."""
    return CvBridge().imgmsg_to_cv2(msg)


def numpy_to_image(arr: Any, encoding: str) -> Any:
    """Return an array of shape (height, width[, channels]) as an image message."""
    return CvBridge().cv2_to_imgmsg(arr, encoding)


def occupancygrid_to_numpy(msg: Any) -> Any:
    """Return a map as a masked array of shape (height, width), with unknown cells masked."""
    import numpy as np

    data: Any = np.asarray(msg.data, dtype=np.int8).reshape(msg.info.height, msg.info.width)
    return np.ma.array(data, mask=data == -1, fill_value=-1)


def numpy_to_occupancy_grid(arr: Any, info: Any = None) -> Any:
    """Return an array of shape (height, width) as a map, with masked cells unknown.

    Raise TypeError unless the array is two-dimensional with type int8.
    """
    import numpy as np

    if arr.ndim != 2 or arr.dtype != np.int8:
        raise TypeError("Array must be 2D and of int8s")
    messages: Any = import_module("nav_msgs.msg")
    grid = messages.OccupancyGrid()
    grid.info = info if info is not None else messages.MapMetaData()
    grid.info.height, grid.info.width = arr.shape
    grid.data = np.ma.filled(arr, -1).ravel().tolist()
    return grid


def pointcloud2_to_array(cloud_msg: Any, squeeze: bool = True) -> Any:
    """Return a cloud as a structured array of shape (height, width), or (points,) if it has one row."""
    import numpy as np

    kind = dtype_from_fields(cloud_msg.fields, cloud_msg.point_step, cloud_msg.is_bigendian)
    points = np.frombuffer(bytes(cloud_msg.data), dtype=kind)
    flat = squeeze and cloud_msg.height == 1
    shape = (cloud_msg.width,) if flat else (cloud_msg.height, cloud_msg.width)
    return points.reshape(shape)


def array_to_pointcloud2(cloud_arr: Any, stamp: Any = None, frame_id: str | None = None) -> Any:
    """Return a structured array with one or two dimensions as a cloud."""
    import numpy as np

    rows: Any = np.atleast_2d(cloud_arr)
    messages: Any = import_module("sensor_msgs.msg")
    cloud = messages.PointCloud2()
    if stamp is not None:
        cloud.header.stamp = stamp
    if frame_id is not None:
        cloud.header.frame_id = frame_id
    cloud.height, cloud.width = rows.shape
    cloud.fields = _fields(rows.dtype, messages.PointField)
    cloud.is_bigendian = False
    cloud.point_step, cloud.row_step = rows.dtype.itemsize, rows.dtype.itemsize * rows.shape[1]
    numbers = [rows[name] for name in rows.dtype.names if rows.dtype[name].kind == "f"]
    cloud.is_dense = all(bool(np.isfinite(one).all()) for one in numbers)
    cloud.data = rows.tobytes()
    return cloud


def _fields(kind: Any, made: Any) -> list[Any]:
    fields = []
    for name in kind.names:
        base, shape = kind[name].subdtype or (kind[name], ())
        count = int(shape[0]) if shape else 1
        fields.append(
            made(name=name, offset=kind.fields[name][1], datatype=_KINDS[base.str[1:]], count=count)
        )
    return fields


def get_xyz_points(cloud_array: Any, remove_nans: bool = True, dtype: Any = float) -> Any:
    """Return the x, y and z of a structured array, shape (…, 3)."""
    import numpy as np

    if remove_nans:
        finite = np.isfinite(cloud_array["x"]) & np.isfinite(cloud_array["y"]) & np.isfinite(cloud_array["z"])
        cloud_array = cloud_array[finite]
    return np.stack([cloud_array[axis] for axis in "xyz"], axis=-1).astype(dtype)


def pointcloud2_to_xyz_array(cloud_msg: Any, remove_nans: bool = True) -> Any:
    """Return the x, y and z of a cloud, shape (points, 3)."""
    return get_xyz_points(pointcloud2_to_array(cloud_msg), remove_nans=remove_nans)


def split_rgb_field(cloud_arr: Any) -> Any:
    """Return a structured array in which the fields r, g and b (uint8) replace the packed field rgb."""
    import numpy as np

    packed = np.ascontiguousarray(cloud_arr["rgb"]).view(np.uint32)
    others = [name for name in cloud_arr.dtype.names if name != "rgb"]
    layout: Any = [
        *((name, cloud_arr.dtype[name]) for name in others),
        *((c, np.uint8) for c in "rgb"),
    ]
    split = np.zeros(cloud_arr.shape, dtype=layout)
    for name in others:
        split[name] = cloud_arr[name]
    for name, shift in (("r", 16), ("g", 8), ("b", 0)):
        split[name] = (packed >> shift) & 255
    return split


_TO_ARRAY: dict[str, Callable[..., Any]] = {
    "geometry_msgs/Vector3": _parts("xyz", 0.0),
    "geometry_msgs/Point": _parts("xyz", 1.0),
    "geometry_msgs/Quaternion": _parts("xyzw", 0.0),
    "geometry_msgs/Pose": lambda msg: _matrix(msg.position, msg.orientation),
    "geometry_msgs/Transform": lambda msg: _matrix(msg.translation, msg.rotation),
    "sensor_msgs/Image": image_to_numpy,
    "nav_msgs/OccupancyGrid": occupancygrid_to_numpy,
    "sensor_msgs/PointCloud2": pointcloud2_to_array,
}
_FROM_ARRAY: dict[str, Callable[..., Any]] = {
    "geometry_msgs/Vector3": _from_parts("xyz"),
    "geometry_msgs/Point": _from_parts("xyz"),
    "geometry_msgs/Quaternion": _from_parts("xyzw"),
    "geometry_msgs/Pose": _pose,
    "geometry_msgs/Transform": _transform,
    "sensor_msgs/Image": lambda _, arr, encoding: numpy_to_image(arr, encoding),
    "nav_msgs/OccupancyGrid": lambda _, arr, info=None: numpy_to_occupancy_grid(arr, info),
    "sensor_msgs/PointCloud2": lambda _, arr, *rest, **named: array_to_pointcloud2(arr, *rest, **named),
}


def __getattr__(name: str) -> Any:
    """Return a submodule that was not imported explicitly; raise for a name that the stand-in lacks."""
    if name in ("geometry", "image", "occupancy_grid", "point_cloud2"):
        return import_module(f"ros_numpy.{name}")
    raise AttributeError(name)
