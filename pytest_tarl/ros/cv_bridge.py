"""cv_bridge with numpy: convert images to arrays and back, between common encodings."""

from __future__ import annotations

import re
from importlib import import_module
from typing import Any

from pytest_tarl.ros.missing import unsupported

__all__ = ["CvBridge", "CvBridgeError", "getCvType"]

_DEPTHS = {
    "8U": "uint8",
    "8S": "int8",
    "16U": "uint16",
    "16S": "int16",
    "32S": "int32",
    "32F": "float32",
    "64F": "float64",
}
_NAMED = {  # encoding → depth, channels
    "mono8": ("8U", 1), "mono16": ("16U", 1), "bgr8": ("8U", 3), "rgb8": ("8U", 3),
    "bgra8": ("8U", 4), "rgba8": ("8U", 4),
    "bgr16": ("16U", 3), "rgb16": ("16U", 3), "bgra16": ("16U", 4), "rgba16": ("16U", 4),
    **{f"bayer_{order}8": ("8U", 1) for order in ("rggb", "bggr", "gbrg", "grbg")},
}  # fmt: skip
_GREY = (0.299, 0.587, 0.114)  # weights of red, green, blue


class CvBridgeError(TypeError):
    """An image cannot be converted."""


class CvBridge:
    """Converts sensor_msgs/Image and CompressedImage."""

    def imgmsg_to_cv2(self, img_msg: Any, desired_encoding: str = "passthrough") -> Any:
        """Return an image message as an array of shape (height, width[, channels])."""
        import numpy as np

        dtype, channels = self.encoding_to_dtype_with_channels(img_msg.encoding)
        kind = np.dtype(dtype).newbyteorder(">" if img_msg.is_bigendian else "<")
        data = img_msg.data if isinstance(img_msg.data, bytes) else bytes(img_msg.data)
        rows = np.frombuffer(data, dtype=np.uint8).reshape(img_msg.height, img_msg.step)
        width = img_msg.width * channels * kind.itemsize
        image = np.frombuffer(np.ascontiguousarray(rows[:, :width]).tobytes(), dtype=kind)
        shape = (
            (img_msg.height, img_msg.width) if channels == 1 else (img_msg.height, img_msg.width, channels)
        )
        image = image.reshape(shape).astype(dtype)
        return (
            image
            if desired_encoding == "passthrough"
            else converted(image, img_msg.encoding, desired_encoding)
        )

    def cv2_to_imgmsg(self, cvim: Any, encoding: str = "passthrough", header: Any = None) -> Any:
        """Return an array of shape (height, width[, channels]) as an image message.

        Raise TypeError if the image is not an array, and CvBridgeError if its type does not fit the encoding.
        """
        if not hasattr(cvim, "dtype"):
            raise TypeError("Your input type is not a numpy array")
        message: Any = import_module("sensor_msgs.msg").Image()
        channels = 1 if cvim.ndim < 3 else cvim.shape[2]
        if encoding == "passthrough":
            encoding = f"{_depth_of(cvim.dtype)}C{channels}"
        elif self.encoding_to_dtype_with_channels(encoding) != (cvim.dtype.name, channels):
            raise CvBridgeError(f"encoding specified as {encoding}, but image has incompatible type "
                                f"{_depth_of(cvim.dtype)}C{channels}")  # fmt: skip
        if header is not None:
            message.header = header
        message.height, message.width, message.encoding = cvim.shape[0], cvim.shape[1], encoding
        message.is_bigendian = type(message.is_bigendian)(cvim.dtype.byteorder == ">")
        message.data = cvim.tobytes()
        message.step = len(message.data) // cvim.shape[0]
        return message

    def compressed_imgmsg_to_cv2(self, cmprs_img_msg: Any, desired_encoding: str = "passthrough") -> Any:
        """Return a compressed message as an array of shape (height, width[, channels]); needs OpenCV.

        Raise CvBridgeError if the message cannot be decoded.
        """
        import numpy as np

        data = np.frombuffer(bytes(cmprs_img_msg.data), dtype=np.uint8)
        image = _opencv("compressed_imgmsg_to_cv2").imdecode(data, -1)
        if image is None:
            raise CvBridgeError("the compressed image cannot be decoded")
        origin = "bgr8" if image.ndim == 3 else "mono8"
        return image if desired_encoding == "passthrough" else converted(image, origin, desired_encoding)

    def cv2_to_compressed_imgmsg(self, cvim: Any, dst_format: str = "jpg") -> Any:
        """Return an array as a compressed message; needs OpenCV."""
        message: Any = import_module("sensor_msgs.msg").CompressedImage()
        _, encoded = _opencv("cv2_to_compressed_imgmsg").imencode(f".{dst_format}", cvim)
        message.format, message.data = dst_format, encoded.tobytes()
        return message

    def encoding_to_dtype_with_channels(self, encoding: str) -> tuple[str, int]:
        """Return numpy type and number of channels of an encoding. Raise CvBridgeError if the encoding is unknown."""
        if encoding in _NAMED:
            depth, channels = _NAMED[encoding]
            return _DEPTHS[depth], channels
        found = re.fullmatch(r"(8U|8S|16U|16S|32S|32F|64F)C?(\d*)", encoding)
        if found is None:
            raise CvBridgeError(f"Unrecognized image encoding [{encoding}]")
        return _DEPTHS[found[1]], int(found[2] or 1)

    def encoding_to_cvtype2(self, encoding: str) -> int:
        """Return OpenCV's type number for an encoding."""
        dtype, channels = self.encoding_to_dtype_with_channels(encoding)
        return list(_DEPTHS.values()).index(dtype) + ((channels - 1) << 3)


def getCvType(encoding: str) -> int:  # noqa: N802 (the library's name)
    """Return OpenCV's type number for an encoding. Raise CvBridgeError if the encoding is unknown."""
    return CvBridge().encoding_to_cvtype2(encoding)


def _depth_of(dtype: Any) -> str:
    for depth, name in _DEPTHS.items():
        if dtype.name == name:
            return depth
    raise CvBridgeError(f"arrays of {dtype.name} cannot be images")


def converted(image: Any, origin: str, wanted: str) -> Any:
    """Convert channels and depth between named encodings. Raise CvBridgeError if there is no conversion."""
    import numpy as np

    if origin == wanted:
        return image
    if (
        wanted not in _NAMED
        or origin not in _NAMED
        or origin.startswith("bayer")
        or wanted.startswith("bayer")
    ):
        if _same_layout(image, wanted):
            return image
        raise CvBridgeError(f"[{origin}] is not a color format and cannot be converted to [{wanted}]")
    red, green, blue, alpha = _channels(image, origin)
    if wanted.startswith("mono"):
        grey = (
            red
            if origin.startswith("mono")
            else sum(
                weight * part.astype(float) for weight, part in zip(_GREY, (red, green, blue), strict=True)
            )
        )
        made = np.rint(grey)
    else:
        named = {"r": red, "g": green, "b": blue, "a": alpha}
        made = np.stack([named[letter] for letter in wanted.rstrip("0123456789")], axis=-1)
    return _scaled(made, image.dtype, np.dtype(_DEPTHS[_NAMED[wanted][0]]))


def _channels(image: Any, origin: str) -> tuple[Any, Any, Any, Any]:
    import numpy as np

    opaque = np.full(image.shape[:2], np.iinfo(image.dtype).max, dtype=image.dtype)
    if origin.startswith("mono"):
        return image, image, image, opaque
    named = {letter: image[..., index] for index, letter in enumerate(origin.rstrip("0123456789"))}
    return named["r"], named["g"], named["b"], named.get("a", opaque)


def _scaled(image: Any, origin: Any, wanted: Any) -> Any:
    if origin == wanted:
        return image.astype(wanted)
    return (image * (257.0 if wanted.itemsize > origin.itemsize else 1 / 257.0)).round().astype(wanted)


def _same_layout(image: Any, wanted: str) -> bool:
    dtype, channels = CvBridge().encoding_to_dtype_with_channels(wanted)
    return image.dtype.name == dtype and (1 if image.ndim < 3 else image.shape[2]) == channels


def _opencv(function: str) -> Any:
    try:
        return import_module("cv2")
    except ImportError as error:
        raise unsupported(
            f"CvBridge.{function} without OpenCV (pip install opencv-python-headless)"
        ) from error
