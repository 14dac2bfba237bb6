"""laser_geometry's Python API for ROS 1 and ROS 2: convert a scan to a point cloud in the laser's frame."""

# ruff: noqa: N802 (names are those of laser_geometry)

from __future__ import annotations

from importlib import import_module
from typing import Any, Final

__all__ = ["LaserProjection"]

_FLOAT32, _INT32 = 7, 5  # PointField.datatype


class LaserProjection:
    """Project scans to point clouds. Beams outside the scan's range are dropped."""

    LASER_SCAN_INVALID: Final = -1.0
    LASER_SCAN_MIN_RANGE: Final = -2.0
    LASER_SCAN_MAX_RANGE: Final = -3.0

    class ChannelOption:
        """Fields of the cloud besides x, y and z; combine them with `|`."""

        NONE: Final = 0x00
        INTENSITY: Final = 0x01
        INDEX: Final = 0x02
        DISTANCE: Final = 0x04
        TIMESTAMP: Final = 0x08
        VIEWPOINT: Final = 0x10
        DEFAULT: Final = INTENSITY | INDEX

    def projectLaser(
        self, scan_in: Any, range_cutoff: float = -1.0, channel_options: int = ChannelOption.DEFAULT
    ) -> Any:
        """Return the cloud of a scan. A `range_cutoff` (m) of at least 0 further limits the range."""
        import numpy as np

        from pytest_tarl.ros.point_cloud2 import create_cloud

        ranges = np.array(scan_in.ranges, dtype=float)
        beams = np.arange(len(ranges))
        angles = scan_in.angle_min + beams * scan_in.angle_increment
        zero = np.zeros(len(ranges))
        columns = {"x": ranges * np.cos(angles), "y": ranges * np.sin(angles), "z": zero}
        options = self.ChannelOption
        if channel_options & options.INTENSITY and len(scan_in.intensities) > 0:
            columns["intensity"] = np.array(scan_in.intensities, dtype=float)
        if channel_options & options.INDEX:
            columns["index"] = beams
        if channel_options & options.DISTANCE:
            columns["distances"] = ranges
        if channel_options & options.TIMESTAMP:
            columns["stamps"] = beams * scan_in.time_increment
        if channel_options & options.VIEWPOINT:
            columns.update(vp_x=zero, vp_y=zero, vp_z=zero)
        most = scan_in.range_max if range_cutoff < 0 else min(range_cutoff, scan_in.range_max)
        kept = np.flatnonzero((ranges < most) & (ranges >= scan_in.range_min)).tolist()
        listed = [column.tolist() for column in columns.values()]
        points = [tuple(column[beam] for column in listed) for beam in kept]
        field: Any = import_module("sensor_msgs.msg").PointField
        fields = [
            field(name=name, offset=4 * place, datatype=_INT32 if name == "index" else _FLOAT32, count=1)
            for place, name in enumerate(columns)
        ]
        return create_cloud(scan_in.header, fields, points)
