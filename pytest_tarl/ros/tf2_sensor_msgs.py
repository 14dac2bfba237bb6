"""tf2_sensor_msgs: transform a point cloud into another frame."""

from __future__ import annotations

from typing import Any

from pytest_tarl.ros.point_cloud2 import create_cloud, read_points_list
from pytest_tarl.ros.transforms import Rigid

__all__ = ["do_transform_cloud"]


def do_transform_cloud(cloud: Any, transform: Any) -> Any:
    """Return the cloud in the transform's frame.

    The first three fields of the cloud are x, y and z; the others stay unchanged.
    """
    move, turn = transform.transform.translation, transform.transform.rotation
    rigid = Rigid((move.x, move.y, move.z), (turn.x, turn.y, turn.z, turn.w))
    points = [(*rigid.apply(tuple(point[:3])), *point[3:]) for point in read_points_list(cloud)]
    return create_cloud(transform.header, cloud.fields, points)
