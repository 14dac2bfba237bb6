"""`image_geometry`: project 3-D points to pixels, with the CameraInfo of one camera or a stereo pair.

Pinhole model: u = (P00 x + P02 z + P03) / z, with the matrices of sensor_msgs/CameraInfo, adjusted for binning and
region of interest. Methods have two names: those of ROS 1 (`fromCameraInfo`), which return a `numpy.matrix`, and those
of ROS 2 (`from_camera_info`), which return a `numpy.ndarray`. Rectifying needs OpenCV.
"""

# ruff: noqa: N802, N803 (image_geometry's names)

from __future__ import annotations

import copy
import math
import warnings
from collections.abc import Sequence
from importlib import import_module
from typing import Any

from pytest_tarl.ros.missing import unsupported

__all__ = ["PinholeCameraModel", "StereoCameraModel"]

Point = Sequence[float]


class PinholeCameraModel:
    """One camera."""

    def __init__(self) -> None:
        self.K: Any = None
        self.D: Any = None
        self.R: Any = None
        self.P: Any = None
        self.full_K: Any = None
        self.full_P: Any = None
        self.width: Any = None
        self.height: Any = None
        self.binning_x: Any = None
        self.binning_y: Any = None
        self.raw_roi: Any = None
        self.tf_frame: Any = None
        self.stamp: Any = None
        self.resolution: tuple[int, int] | None = None

    def fromCameraInfo(self, msg: Any) -> None:
        """Read the parameters from a sensor_msgs/CameraInfo of either ROS generation."""
        k, d, r, p = (getattr(msg, name if hasattr(msg, name) else name.lower()) for name in "KDRP")
        self.K, self.full_K = _matrix(k, 3, 3), _matrix(k, 3, 3)
        self.P, self.full_P = _matrix(p, 3, 4), _matrix(p, 3, 4)
        self.D = _matrix(d, len(d), 1) if len(d) else None
        self.R = _matrix(r, 3, 3)
        self.width, self.height = msg.width, msg.height
        self.resolution = (msg.width, msg.height)
        self.binning_x, self.binning_y = max(1, msg.binning_x), max(1, msg.binning_y)
        roi = self.raw_roi = copy.copy(msg.roi)
        # a region of zeros means the whole image
        if not any((roi.x_offset, roi.y_offset, roi.width, roi.height)):
            roi.width, roi.height = msg.width, msg.height
        self.tf_frame, self.stamp = msg.header.frame_id, msg.header.stamp
        for row, offset, binning in ((0, roi.x_offset, self.binning_x), (1, roi.y_offset, self.binning_y)):
            for matrix in (self.K, self.P):
                matrix[row, row] /= binning
                matrix[row, 2] = (matrix[row, 2] - offset) / binning

    def project3dToPixel(self, point: Point) -> tuple[float, float]:
        """Return the rectified pixel of a point (x, y, z); NaN if its depth z is 0."""
        x, y, w = (self.P @ _matrix([*point[:3], 1.0], 4, 1)).A1.tolist()
        return (x / w, y / w) if w else (math.nan, math.nan)

    def projectPixelTo3dRay(self, uv: Point) -> tuple[float, float, float]:
        """Return the unit vector from the camera through a rectified pixel."""
        x, y = (uv[0] - self.cx()) / self.fx(), (uv[1] - self.cy()) / self.fy()
        norm = math.sqrt(x * x + y * y + 1)
        return x / norm, y / norm, 1.0 / norm

    def projectPixelTo3d(self, uv: Point, depth: float) -> tuple[float, float, float]:
        """Return the point at a rectified pixel and depth z."""
        return (uv[0] - self.cx()) / self.fx() * depth, (uv[1] - self.cy()) / self.fy() * depth, depth

    def rectifyImage(self, raw: Any, rectified: Any) -> None:
        """Rectify the image `raw` into the array `rectified`."""
        cv2 = _opencv("PinholeCameraModel.rectifyImage")
        self.mapx, self.mapy = cv2.initUndistortRectifyMap(
            self.K, self.D, self.R, self.P, (self.width, self.height), cv2.CV_32FC1
        )
        cv2.remap(raw, self.mapx, self.mapy, cv2.INTER_CUBIC, rectified)

    def rectifyPoint(self, uv_raw: Point) -> Any:
        """Return the rectified pixel of a raw one."""
        import numpy as np

        cv2 = _opencv("PinholeCameraModel.rectifyPoint")
        raw = np.array([[list(uv_raw)]], dtype="float64")
        return cv2.undistortPoints(raw, self.K, self.D, R=self.R, P=self.P)[0, 0]

    def getDeltaU(self, deltaX: float, Z: float) -> float:
        """Return the width in pixels of a horizontal length at depth Z."""
        return math.inf if Z == 0 else self.fx() * deltaX / Z

    def getDeltaV(self, deltaY: float, Z: float) -> float:
        """Return the height in pixels of a vertical length at depth Z."""
        return math.inf if Z == 0 else self.fy() * deltaY / Z

    def getDeltaX(self, deltaU: float, Z: float) -> float:
        """Return the horizontal length of a number of pixels at depth Z."""
        return Z * deltaU / self.fx()

    def getDeltaY(self, deltaV: float, Z: float) -> float:
        """Return the vertical length of a number of pixels at depth Z."""
        return Z * deltaV / self.fy()

    def fullResolution(self) -> tuple[int, int] | None:
        """Return width and height."""
        return self.resolution

    def intrinsicMatrix(self) -> Any:
        """Return K, adjusted for binning and region of interest."""
        return self.K

    def distortionCoeffs(self) -> Any:
        """Return D as a column, or None if there is no distortion."""
        return self.D

    def rotationMatrix(self) -> Any:
        """Return R."""
        return self.R

    def projectionMatrix(self) -> Any:
        """Return P, adjusted for binning and region of interest."""
        return self.P

    def fullIntrinsicMatrix(self) -> Any:
        """Return K for the full resolution."""
        return self.full_K

    def fullProjectionMatrix(self) -> Any:
        """Return P for the full resolution."""
        return self.full_P

    def cx(self) -> float:
        """Return the x coordinate of the optical centre, in pixels."""
        return float(self.P[0, 2])

    def cy(self) -> float:
        """Return the y coordinate of the optical centre, in pixels."""
        return float(self.P[1, 2])

    def fx(self) -> float:
        """Return the horizontal focal length, in pixels."""
        return float(self.P[0, 0])

    def fy(self) -> float:
        """Return the vertical focal length, in pixels."""
        return float(self.P[1, 1])

    def Tx(self) -> float:
        """Return the first element of the last column of P."""
        return float(self.P[0, 3])

    def Ty(self) -> float:
        """Return the second element of the last column of P."""
        return float(self.P[1, 3])

    def fovX(self) -> float:
        """Return the horizontal field of view, in radians."""
        return 2 * math.atan(self.width / (2 * self.fx()))

    def fovY(self) -> float:
        """Return the vertical field of view, in radians."""
        return 2 * math.atan(self.height / (2 * self.fy()))

    def tfFrame(self) -> Any:
        """Return the camera's tf frame."""
        return self.tf_frame

    from_camera_info = fromCameraInfo
    project_3d_to_pixel = project3dToPixel
    project_pixel_to_3d_ray = projectPixelTo3dRay
    rectify_image = rectifyImage
    rectify_point = rectifyPoint
    get_delta_u = getDeltaU
    get_delta_v = getDeltaV
    get_delta_x = getDeltaX
    get_delta_y = getDeltaY
    full_resolution = fullResolution
    tx = Tx
    ty = Ty
    fov_x = fovX
    fov_y = fovY
    get_tf_frame = tfFrame

    def intrinsic_matrix(self) -> Any:
        """Return K as an array of 3 × 3, adjusted for binning and region of interest."""
        return _array(self.K)

    def distortion_coeffs(self) -> Any:
        """Return D as an array of one column, or None if there is no distortion."""
        return _array(self.D)

    def rotation_matrix(self) -> Any:
        """Return R as an array of 3 × 3."""
        return _array(self.R)

    def projection_matrix(self) -> Any:
        """Return P as an array of 3 × 4, adjusted for binning and region of interest."""
        return _array(self.P)

    def full_intrinsic_matrix(self) -> Any:
        """Return K as an array of 3 × 3, for the full resolution."""
        return _array(self.full_K)

    def full_projection_matrix(self) -> Any:
        """Return P as an array of 3 × 4, for the full resolution."""
        return _array(self.full_P)


class StereoCameraModel:
    """Two cameras side by side; points are in the frame of the left one."""

    def __init__(self) -> None:
        self.left = PinholeCameraModel()
        self.right = PinholeCameraModel()
        self.Q: Any = None

    def fromCameraInfo(self, left_msg: Any, right_msg: Any) -> None:
        """Read the parameters of both cameras."""
        self.left.fromCameraInfo(left_msg)
        self.right.fromCameraInfo(right_msg)
        right = self.right
        self.Q = _matrix([1, 0, 0, -right.cx(), 0, 1, 0, -right.cy(), 0, 0, 0, right.fx(), 0, 0, 1, 0], 4, 4)
        self.Q[3, 2] = -right.fx() / right.Tx()

    def project3dToPixel(self, point: Point) -> tuple[tuple[float, float], tuple[float, float]]:
        """Return the rectified pixels of a point in the left and right image."""
        return self.left.project3dToPixel(point), self.right.project3dToPixel(point)

    def projectPixelTo3d(self, left_uv: Point, disparity: float) -> tuple[float, float, float]:
        """Return the point at a pixel of the left image with this disparity in pixels."""
        x, y, z, w = (self.Q @ _matrix([left_uv[0], left_uv[1], disparity, 1.0], 4, 1)).A1.tolist()
        return (x / w, y / w, z / w) if w else (0.0, 0.0, 0.0)

    def getZ(self, disparity: float) -> float:
        """Return the depth for a disparity; infinite for disparity 0."""
        return math.inf if disparity == 0 else -self.right.Tx() / disparity

    def getDisparity(self, Z: float) -> float:
        """Return the disparity at depth Z."""
        return math.inf if Z == 0 else -self.right.Tx() / Z

    def tfFrame(self) -> Any:
        """Return the left camera's tf frame."""
        return self.left.tfFrame()

    from_camera_info = fromCameraInfo
    project_3d_to_pixel = project3dToPixel
    project_pixel_to_3d = projectPixelTo3d
    get_z = getZ
    get_disparity = getDisparity
    get_tf_frame = tfFrame

    def get_left_camera(self) -> PinholeCameraModel:
        """Return the left camera."""
        return self.left

    def get_right_camera(self) -> PinholeCameraModel:
        """Return the right camera."""
        return self.right


def _matrix(numbers: Sequence[float], rows: int, columns: int) -> Any:
    import numpy as np

    with warnings.catch_warnings():
        warnings.simplefilter(
            "ignore", PendingDeprecationWarning
        )  # image_geometry returns numpy.matrix, although numpy warns that it is outdated
        return np.matrix(np.array(list(numbers), dtype="float64").reshape(rows, columns))


def _array(matrix: Any) -> Any:
    """Return a matrix as an array view, and None as None."""
    return None if matrix is None else matrix.A


def _opencv(what: str) -> Any:
    try:
        return import_module("cv2")
    except ImportError:
        raise unsupported(f"{what} without OpenCV (pip install opencv-python)") from None
