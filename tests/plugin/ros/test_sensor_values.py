"""Values of clouds, images and cameras, worked out by hand."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from pytest_tarl.ros import message_type, point_cloud2
from pytest_tarl.ros.cv_bridge import CvBridge, CvBridgeError, getCvType
from pytest_tarl.ros.image_geometry import PinholeCameraModel, StereoCameraModel
from tests.plugin.ros.test_helpers import picture
from tests.plugin.ros.test_more_names import camera

FIELDS = [("x", 0, 7, 1), ("flag", 4, 2, 1), ("pair", 6, 3, 2), ("y", 12, 7, 0)]  # a gap after the flag
LAYOUT = {"names": ["x", "flag", "pair", "y"], "formats": ["f4", "u1", ("i2", (2,)), "f4"],
          "offsets": [0, 4, 6, 12], "itemsize": 20}  # fmt: skip


def cloud(kind: str, *, dense: bool = False, bigendian: bool = False) -> Any:
    """Return an organised cloud of 2 rows and 3 columns, with 5 unused bytes after each row."""
    dtype: Any = np.dtype
    points = np.zeros((2, 3), dtype=dtype(LAYOUT))
    points["x"], points["y"] = [[0, 1, 2], [3, np.nan, 5]], [[0, 10, np.nan], [30, 40, 50]]
    points["flag"], points["pair"][..., 1] = [[1, 2, 3], [4, 5, 6]], 7
    if bigendian:
        points = points.astype(points.dtype.newbyteorder(">"))
    field: Any = message_type(f"sensor_msgs/{kind}PointField")
    made: Any = message_type(f"sensor_msgs/{kind}PointCloud2")()
    made.fields = [field(name=n, offset=o, datatype=t, count=c) for n, o, t, c in FIELDS]
    made.height, made.width, made.point_step, made.row_step = 2, 3, 20, 65
    made.is_dense, made.is_bigendian = dense, bigendian
    made.data = b"".join(row.tobytes() + b"extra" for row in points)
    return made


@pytest.mark.parametrize("kind", ["", "msg/"])
@pytest.mark.parametrize("bigendian", [False, True])
def test_points_are_read_without_row_padding(kind: str, bigendian: bool) -> None:
    points = list(point_cloud2.read_points(cloud(kind, bigendian=bigendian), ["x", "flag"]))
    assert [int(flag) for _, flag in points] == [1, 2, 3, 4, 5, 6]
    assert [float(x) for x, _ in points] == pytest.approx([0, 1, 2, 3, np.nan, 5], nan_ok=True)
    every = point_cloud2.read_points_list(cloud(kind, bigendian=bigendian))
    assert (every[3].x, every[3].flag, list(every[3].pair), every[3].y) == (3, 4, [0, 7], 30)


def test_ros1_pixels_select_points() -> None:
    made = cloud("")
    assert [x for (x,) in point_cloud2.read_points(made, ["x"], uvs=[(2, 0), (0, 1)])] == [2, 3]
    assert [x for (x,) in point_cloud2.read_points(made, ["x"], uvs=np.array([(2, 1)]))] == [5]
    assert len(list(point_cloud2.read_points(made, ["x"], uvs=[]))) == 6
    assert [x for (x,) in point_cloud2.read_points(made, ["x"], skip_nans=True, uvs=[(1, 1), (0, 1)])] == [3]


def test_ros2_indices_ignore_nan_points() -> None:
    made = cloud("msg/")
    assert point_cloud2.read_points(made, ["x"], uvs=[2, 0])["x"].tolist() == [2, 0]
    assert point_cloud2.read_points(made, ["x"], skip_nans=True, uvs=np.array([4]))["x"].tolist() == [5]
    assert len(point_cloud2.read_points(made, uvs=[])) == 0


def test_points_with_requested_nan_are_left_out() -> None:
    def flags(made: Any, names: list[str]) -> list[int]:
        return [int(flag) for *_, flag in point_cloud2.read_points(made, [*names, "flag"], skip_nans=True)]

    assert flags(cloud(""), []) == [1, 2, 3, 4, 5, 6]
    assert flags(cloud(""), ["x"]) == [1, 2, 3, 4, 6]
    assert flags(cloud("msg/"), ["x", "y"]) == [1, 2, 4, 6]
    assert flags(cloud("", dense=True), ["x"]) == [1, 2, 3, 4, 6]
    assert flags(cloud("msg/", dense=True), ["x"]) == [1, 2, 3, 4, 5, 6]  # dense clouds have no NaN


def test_an_organised_cloud_keeps_its_shape_on_request() -> None:
    assert point_cloud2.read_points(cloud("msg/"), ["x"], reshape_organized_cloud=True).shape == (2, 3)
    assert point_cloud2.read_points(cloud("msg/"), ["x"]).shape == (6,)
    flat = cloud("msg/")
    flat.height, flat.data = 1, flat.data[:65]
    assert point_cloud2.read_points(flat, ["x"], reshape_organized_cloud=True).shape == (3,)


def test_plain_arrays_need_fields_of_one_type() -> None:
    numbers = point_cloud2.read_points_numpy(cloud("msg/"), ["y", "x"], skip_nans=True)
    assert numbers.tolist() == [[0, 0], [10, 1], [30, 3], [50, 5]]
    with pytest.raises(AssertionError, match="same datatype"):
        point_cloud2.read_points_numpy(cloud("msg/"), ["x", "flag"])
    with pytest.raises(AssertionError, match=r"not in the fields.*'z'"):
        point_cloud2.read_points(cloud("msg/"), ["x", "z"])


def test_images_are_read_without_padding_in_their_byte_order() -> None:
    depth = np.array([[1, 2], [300, 400]], dtype=">u2")
    made: Any = message_type("sensor_msgs/Image")()
    made.height, made.width, made.encoding, made.is_bigendian, made.step = 2, 2, "mono16", 1, 7
    made.data = b"".join(row.tobytes() + b"pad" for row in depth)
    found = CvBridge().imgmsg_to_cv2(made)
    assert (found.tolist(), found.dtype.name) == ([[1, 2], [300, 400]], "uint16")


RGBA = np.array([[[10, 20, 30, 40], [200, 100, 50, 255]]], dtype=np.uint8)


@pytest.mark.parametrize(
    ("wanted", "pixel"),
    [
        ("rgba8", [10, 20, 30, 40]),
        ("bgra8", [30, 20, 10, 40]),
        ("rgb8", [10, 20, 30]),
        ("bgr8", [30, 20, 10]),
        ("mono8", round(0.299 * 10 + 0.587 * 20 + 0.114 * 30)),
        ("mono16", round(257 * round(0.299 * 10 + 0.587 * 20 + 0.114 * 30))),
        ("bgra16", [30 * 257, 20 * 257, 10 * 257, 40 * 257]),
        ("8UC4", [10, 20, 30, 40]),
    ],
)
def test_colours_are_reordered_weighed_and_scaled(wanted: str, pixel: Any) -> None:
    assert CvBridge().imgmsg_to_cv2(picture("rgba8", RGBA), wanted)[0, 0].tolist() == pixel


def test_grey_images_become_opaque_colours() -> None:
    grey = np.array([[0, 257, 385, 386, 65535]], dtype=np.uint16)
    bridge = CvBridge()
    assert bridge.imgmsg_to_cv2(picture("mono16", grey), "mono8").tolist() == [[0, 1, 1, 2, 255]]
    assert bridge.imgmsg_to_cv2(picture("mono16", grey), "rgba16")[0, 1].tolist() == [257, 257, 257, 65535]
    assert bridge.imgmsg_to_cv2(picture("mono16", grey), "bgra8")[0, 4].tolist() == [255, 255, 255, 255]


@pytest.mark.parametrize(
    ("encoding", "wanted"),
    [
        ("bayer_rggb8", "rgb8"),
        ("rgb8", "bayer_rggb8"),
        ("rgb8", "8UC4"),
        ("8UC3", "mono8"),
        ("rgb8", "16UC3"),
    ],
)
def test_conversions_from_encodings_that_are_not_colours_are_refused(encoding: str, wanted: str) -> None:
    image = np.zeros((2, 2) if encoding.startswith("bayer") else (2, 2, 3), dtype=np.uint8)
    with pytest.raises(CvBridgeError, match=rf"\[{encoding}\] is not a color format"):
        CvBridge().imgmsg_to_cv2(picture(encoding, image), wanted)


@pytest.mark.parametrize(
    ("encoding", "number"),
    [
        ("8UC1", 0),
        ("8UC3", 16),
        ("16UC1", 2),
        ("32FC1", 5),
        ("64FC4", 30),
        ("bgr8", 16),
        ("mono16", 2),
        ("32F", 5),
    ],
)
def test_encodings_have_the_numbers_of_opencv(encoding: str, number: int) -> None:
    assert getCvType(encoding) == number


@pytest.mark.parametrize("encoding", ["rgb9", "8UC", "8UCx", "7UC1"])
def test_unknown_encodings_are_refused(encoding: str) -> None:
    if encoding == "8UC":
        assert CvBridge().encoding_to_dtype_with_channels(encoding) == ("uint8", 1)
    else:
        with pytest.raises(CvBridgeError, match="Unrecognized"):
            getCvType(encoding)


def test_a_camera_converts_between_lengths_and_pixels() -> None:
    model = PinholeCameraModel()
    model.fromCameraInfo(camera(tx=5.0))
    assert (model.fx(), model.fy(), model.cx(), model.cy(), model.Tx(), model.Ty()) == (
        100,
        120,
        32,
        24,
        5,
        0,
    )
    assert (model.getDeltaU(0.5, 2.0), model.getDeltaV(0.5, 2.0)) == (25, 30)
    assert (model.getDeltaX(25, 2.0), model.getDeltaY(30, 2.0)) == (0.5, 0.5)
    assert (model.getDeltaU(0.5, 0), model.getDeltaV(0.5, 0)) == (math.inf, math.inf)
    assert model.fovY() == pytest.approx(2 * math.atan(0.2))
    assert model.projectPixelTo3d((57.0, 9.0), 2.0) == pytest.approx((0.5, -0.25, 2.0))
    assert model.fullResolution() == (64, 48)
    assert model.projectionMatrix().tolist()[0] == [100, 0, 32, 5]
    assert model.rotationMatrix().tolist() == np.identity(3).tolist()


def test_a_camera_has_the_names_of_ros2() -> None:
    info: Any = camera(tx=5.0)
    info.D = [0.1, 0.2]
    model = PinholeCameraModel()
    model.from_camera_info(info)
    assert model.project_3d_to_pixel((0.5, -0.25, 2.0)) == model.project3dToPixel((0.5, -0.25, 2.0))
    assert model.project_pixel_to_3d_ray((32, 24)) == (0, 0, 1)
    assert (model.get_delta_u(0.5, 2.0), model.get_delta_v(0.5, 2.0)) == (25, 30)
    assert (model.get_delta_x(25, 2.0), model.get_delta_y(30, 2.0)) == (0.5, 0.5)
    assert (model.full_resolution(), model.get_tf_frame(), model.tx(), model.ty()) == ((64, 48), "lens", 5, 0)
    assert (model.fov_x(), model.fov_y()) == (model.fovX(), model.fovY())
    for name, shape in {"intrinsic_matrix": (3, 3), "rotation_matrix": (3, 3), "projection_matrix": (3, 4),
                        "full_intrinsic_matrix": (3, 3), "full_projection_matrix": (3, 4),
                        "distortion_coeffs": (2, 1)}.items():  # fmt: skip
        matrix = getattr(model, name)()
        assert (type(matrix), matrix.shape) == (np.ndarray, shape), name
    assert model.projection_matrix()[0].tolist() == [100, 0, 32, 5]
    model.from_camera_info(camera())
    assert model.distortion_coeffs() is None
    pair = StereoCameraModel()
    pair.from_camera_info(camera(), camera(tx=-20.0))
    assert (pair.get_left_camera().tx(), pair.get_right_camera().tx()) == (0, -20)
    assert (pair.get_z(10.0), pair.get_disparity(2.0), pair.get_tf_frame()) == (2, 10, "lens")
    left, right = pair.project_3d_to_pixel((0.2, 0.24, 2.0))
    assert left[0] - right[0] == pytest.approx(10)
    assert pair.project_pixel_to_3d(left, 10.0)[2] == 2


@pytest.mark.parametrize("names", [("x_offset",), ("y_offset",), ("width",), ("height",), ()])
def test_zero_region_of_interest_is_the_whole_image(names: tuple[str, ...]) -> None:
    info: Any = camera()
    info.binning_x, info.binning_y = 4, 2
    info.D = [0.1, 0.2]
    for name in names:
        setattr(info.roi, name, 8)
    model = PinholeCameraModel()
    model.fromCameraInfo(info)
    size = tuple(8 if name in names else 0 for name in ("width", "height")) if names else (64, 48)
    assert (model.raw_roi.width, model.raw_roi.height) == size
    assert (model.fx(), model.fy()) == (25, 60)
    assert model.cx() == (32 - 8 * ("x_offset" in names)) / 4
    assert model.cy() == (24 - 8 * ("y_offset" in names)) / 2
    assert model.intrinsicMatrix()[1, 2] == model.cy()
    assert model.fullProjectionMatrix()[0, 2] == 32
    assert model.distortionCoeffs().tolist() == [[0.1], [0.2]]
    assert (info.roi.width, info.roi.height) == tuple(8 if n in names else 0 for n in ("width", "height"))


def test_a_stereo_camera_has_no_point_at_zero_disparity() -> None:
    model = StereoCameraModel()
    model.fromCameraInfo(camera(), camera(tx=-20.0))
    assert model.projectPixelTo3d((42.0, 36.0), 10.0) == pytest.approx(
        (0.2, 0.24, 2.0)  # one focal length for both axes, as in the library
    )
    assert model.projectPixelTo3d((42.0, 36.0), 0.0) == (0, 0, 0)
    assert (model.getZ(0), model.getDisparity(0), model.tfFrame()) == (math.inf, math.inf, "lens")
    assert (model.getZ(10.0), model.getDisparity(2.0)) == (2, 10)
