"""Nodes with interactive markers; the test sends the feedback messages of a user."""

from __future__ import annotations

from typing import Any

import pytest

from pytest_tarl.errors import UnsupportedApiError
from pytest_tarl.ros import message_type
from tests.plugin.ros.conftest import Start, heard

ROSPY = """
import rospy
from interactive_markers.interactive_marker_server import *
from interactive_markers.menu_handler import *
rospy.init_node("markers")
server = InteractiveMarkerServer("arm")
spin = rospy.spin
"""
RCLPY = """
import rclpy
from interactive_markers import InteractiveMarkerServer, MenuHandler
from visualization_msgs.msg import InteractiveMarker, InteractiveMarkerFeedback
rclpy.init()
node = rclpy.create_node("markers")
server = InteractiveMarkerServer(node, "arm")
spin = lambda: rclpy.spin(node)
"""
BODY = """
calls = []
marker = InteractiveMarker()
marker.name = "goal"
marker.header.frame_id = "base"
server.insert(marker, lambda feedback: calls.append(("any", feedback.event_type)))
server.setCallback("goal", lambda feedback: calls.append(("button", feedback.control_name)),
                   InteractiveMarkerFeedback.BUTTON_CLICK)
menu = MenuHandler()
parent = menu.insert("more")
chosen = menu.insert("stop", parent=parent, callback=lambda feedback: calls.append(("stop", feedback.menu_entry_id)))
menu.setCheckState(chosen, MenuHandler.CHECKED)
assert menu.apply(server, "goal") and not menu.apply(server, "nothing")
server.applyChanges()
spin()
"""
PACKAGE = {ROSPY: "visualization_msgs/", RCLPY: "visualization_msgs/msg/"}


@pytest.fixture(params=[ROSPY, RCLPY], ids=["rospy", "rclpy"])
def head(request: pytest.FixtureRequest) -> str:
    return str(request.param)


def feedback(head: str, **fields: Any) -> Any:
    made: Any = message_type(PACKAGE[head] + "InteractiveMarkerFeedback")
    return made(marker_name="goal", **fields)


def test_a_new_client_receives_all_markers_with_their_menus(head: str, start: Start) -> None:
    ros = start(head + BODY)
    ros.step(0.1)
    full: Any = ros.bus.latest("/arm/update_full")
    assert [one.name for one in full.markers] == ["goal"]
    entries = [(one.id, one.parent_id, one.title) for one in full.markers[0].menu_entries]
    assert entries == [(1, 0, "more"), (2, 1, "[x] stop")]


def test_feedback_reaches_the_callback_of_its_event(head: str, start: Start) -> None:
    ros = start(head + BODY)
    ros.step(0.1)
    kinds: Any = feedback(head)
    ros.bus.publish("/arm/feedback", feedback(head, event_type=kinds.MOUSE_DOWN))
    ros.bus.publish("/arm/feedback", feedback(head, event_type=kinds.BUTTON_CLICK, control_name="grip"))
    ros.bus.publish("/arm/feedback", feedback(head, event_type=kinds.MENU_SELECT, menu_entry_id=2))
    unknown = feedback(head, event_type=kinds.MOUSE_DOWN)
    unknown.marker_name = "nothing"
    ros.bus.publish("/arm/feedback", unknown)
    ros.step(0.1)
    assert ros.namespace["calls"] == [("any", kinds.MOUSE_DOWN), ("button", "grip"), ("stop", 2)]  # type: ignore[attr-defined]


def test_a_dragged_marker_moves_and_changes_are_published_together(head: str, start: Start) -> None:
    ros = start(head + BODY)
    ros.step(0.1)
    updates = heard(ros, "/arm/update")
    moved: Any = feedback(head)
    moved.event_type, moved.pose.position.x = moved.POSE_UPDATE, 0.5
    ros.bus.publish("/arm/feedback", moved)
    ros.step(0.1)
    server: Any = ros.namespace["server"]  # type: ignore[attr-defined]
    assert server.get("goal").pose.position.x == 0.5
    assert server.get("goal").header.frame_id == "base"
    assert not updates


def test_erased_markers_are_gone_after_the_changes_are_applied(head: str, start: Start) -> None:
    erase = """
server.applyChanges()
assert server.erase("goal") and not server.setPose("goal", marker.pose)
assert server.get("goal") is None
server.applyChanges()
spin()
"""
    ros = start(head + BODY.replace("server.applyChanges()\nspin()\n", erase))
    ros.step(0.1)
    update: Any = ros.bus.latest("/arm/update")
    assert (list(update.erases), list(update.markers)) == (["goal"], [])
    full: Any = ros.bus.latest("/arm/update_full")
    assert not full.markers


@pytest.mark.parametrize("module", ["interactive_markers", "interactive_markers.interactive_marker_server"])
def test_missing_ros_name_is_reported_in_one_sentence(module: str, start: Start) -> None:
    with pytest.raises(UnsupportedApiError, match=rf"{module}\.InteractiveMarkerClient"):
        start(f"import rospy, {module}\n{module}.InteractiveMarkerClient")
