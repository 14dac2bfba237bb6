"""`cv_bridge.boost.cv_bridge_boost`: OpenCV's type numbers, and conversion between encodings, in numpy."""

from __future__ import annotations

from typing import Any

from pytest_tarl.ros.cv_bridge import converted, getCvType

__all__ = ["CV_MAT_CNWrap", "CV_MAT_DEPTHWrap", "cvtColor2", "getCvType"]


def cvtColor2(image: Any, encoding_in: str, encoding_out: str) -> Any:  # noqa: N802 (the module's name)
    """Return an image in another encoding. Raise CvBridgeError if there is no conversion."""
    return converted(image, encoding_in, encoding_out)


def CV_MAT_CNWrap(i: int) -> int:  # noqa: N802
    """Return the number of channels of an OpenCV type."""
    return ((i >> 3) & 511) + 1


def CV_MAT_DEPTHWrap(i: int) -> int:  # noqa: N802
    """Return the depth of an OpenCV type."""
    return i & 7
