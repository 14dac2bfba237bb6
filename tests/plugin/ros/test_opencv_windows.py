"""Windows of OpenCV are discarded for nodes; the keys that the test types reach `cv2.waitKey`."""

from __future__ import annotations

import importlib
import sys
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType

import pytest

from pytest_tarl.ros import Ros
from pytest_tarl.ros.opencv_windows import windows_discarded
from tests.plugin.ros.conftest import Start, heard

CV2 = """
drawn = []
namedWindow = imshow = destroyAllWindows = waitKey = pollKey = drawn.append  # built-in functions, as in OpenCV
createTrackbar = getTrackbarPos = setTrackbarPos = getWindowProperty = moveWindow = drawn.append
WND_PROP_VISIBLE = 4
def cvtColor(image, code): return image
"""
NODE = """
import cv2
import rospy
from std_msgs.msg import Int64

rospy.init_node("viewer")
out = rospy.Publisher("keys", Int64, queue_size=10)
cv2.namedWindow("view", 1)
cv2.moveWindow("view", 0, 0)
{body}
"""
LOOP = """
while not rospy.is_shutdown():
    {wait}
    if not rospy.is_shutdown():
        out.publish(key)
"""


@pytest.fixture(autouse=True)
def opencv(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """Put a module cv2 on the search path whose functions fail when a node calls them."""
    (tmp_path / "lib").mkdir()
    (tmp_path / "lib" / "cv2.py").write_text(CV2)
    monkeypatch.syspath_prepend(tmp_path / "lib")
    before = sys.modules.pop("cv2", None)
    yield
    sys.modules.pop("cv2", None)
    if before is not None:
        sys.modules["cv2"] = before


def library() -> ModuleType:
    return importlib.import_module("cv2")


def test_window_is_not_drawn_and_waits_virtually(start: Start) -> None:
    ros = start(NODE.format(body=LOOP.format(wait="cv2.imshow('view', None); key = cv2.waitKey(100)")))
    keys = heard(ros, "/keys")
    ros.step(0.05)
    ros.step(1.0)
    assert [one.data for one in keys] == [-1] * 10
    ros.type("q")
    ros.step(0.0)
    assert keys[-1].data == ord("q")
    assert not library().drawn
    ros.close()
    assert not ros.shutdown_errors


def test_unlimited_wait_ends_with_a_key(start: Start) -> None:
    ros = start(NODE.format(body=LOOP.format(wait="key = cv2.waitKey() & 0xFF")))
    keys = heard(ros, "/keys")
    ros.step(5.0)
    assert not keys
    assert ros.notes == (
        "Node '/viewer' waits for the keyboard, but the test types nothing: call tarl.type(text).",
    )
    ros.type("ab")
    ros.step(0.1)
    assert [one.data for one in keys] == [ord("a"), ord("b")]
    ros.close()
    assert not ros.shutdown_errors


def test_a_loop_that_polls_keys_lets_time_pass(start: Start) -> None:
    ros = start(NODE.format(body="while cv2.pollKey() != ord('q'):\n    pass\nout.publish(1)"))
    keys = heard(ros, "/keys")
    ros.step(1.0)
    ros.type("q")
    ros.step(1.0)
    assert [one.data for one in keys] == [1]


def test_trackbars_keep_their_values(start: Start) -> None:
    body = """
moved = []
cv2.createTrackbar("gain", "view", 3, 10, moved.append)
rospy.sleep(0.1)
out.publish(cv2.getTrackbarPos("gain", "view"))
cv2.setTrackbarPos("gain", "view", 7)
cv2.setTrackbarPos("gain", "view", 7)
out.publish(cv2.getTrackbarPos("gain", "view"))
out.publish(cv2.getTrackbarPos("none", "view"))
out.publish(int(cv2.getWindowProperty("view", cv2.WND_PROP_VISIBLE)))
cv2.destroyAllWindows()
out.publish(int(cv2.getWindowProperty("view", cv2.WND_PROP_VISIBLE)))
"""
    ros = start(NODE.format(body=body))
    keys = heard(ros, "/keys")
    ros.step(1.0)
    assert [one.data for one in keys] == [3, 7, -1, 1, -1]
    assert ros.namespace["moved"] == [7]  # type: ignore[attr-defined]


@pytest.mark.parametrize("imported_before", [False, True])
def test_the_library_is_as_before_after_the_episode(imported_before: bool, start: Start) -> None:
    if imported_before:
        library()
    ros = Ros()
    with ros.installed():
        start(NODE.format(body="cv2.imshow('view', cv2.cvtColor(1, 2))"), ros=ros)
        ros.step(0.1)
        library().imshow("by the test")  # outside nodes, the function is the library's
    ros.close()
    assert library().drawn == ["by the test"]
    library().imshow("later")
    assert library().drawn == ["by the test", "later"]
    spec = library().__spec__
    assert spec is not None
    assert type(spec.loader).__module__.startswith("_frozen_importlib")


def test_a_function_that_the_test_sets_is_not_replaced(start: Start, monkeypatch: pytest.MonkeyPatch) -> None:
    seen: list[str] = []
    monkeypatch.setattr(library(), "imshow", lambda name, image: seen.append(name))
    with windows_discarded():
        ros = start(NODE.format(body="cv2.imshow('view', None)"))
        ros.step(0.1)
    assert seen == ["view"]


def test_test_replacement_leaves_the_library_usable(start: Start) -> None:
    cv2 = library()
    patch = pytest.MonkeyPatch()
    with windows_discarded():
        patch.setattr(cv2, "imshow", lambda *_: None)
    patch.undo()  # restores the replacement of an episode that is over
    cv2.imshow("by the test")
    assert cv2.drawn == ["by the test"]
    with windows_discarded():
        pass
    assert cv2.imshow == cv2.drawn.append


def test_error_names_the_missing_opencv_package(start: Start, tmp_path: Path) -> None:
    (tmp_path / "lib" / "cv2.py").unlink()
    importlib.invalidate_caches()
    if importlib.util.find_spec("cv2") is not None:
        pytest.skip("OpenCV is installed")
    with pytest.raises(Exception, match="opencv-python-headless"):
        start(NODE.format(body="")).step(0.1)
