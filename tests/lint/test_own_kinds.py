"""Services, actions and transforms are separate kinds of sources and sinks, identified by their `api`."""

from pathlib import Path

from tarl_lint import engine
from tarl_lint.catalog import on_topic
from tarl_lint.read.source import Module, parse
from tarl_lint.settings.config import Config

CASES = Path(__file__).parent.parent / "cases"


def flows(case, **settings):
    module = parse("node.py", (CASES / case).read_bytes(), "node")
    assert isinstance(module, Module)
    return engine.analyse([module], Config(**settings))


def ends(case, **settings):
    return {(f.source.api, f.sink.api) for f in flows(case, **settings)}


def test_rospy_service_is_a_source_and_its_response_a_sink():
    found = ends("sources/service_requests.py")
    assert ("rospy.Service", "rospy.Publisher.publish") in found
    assert ("rospy.Service", "rospy.Service.response") in found


def test_rclpy_service_is_a_source_and_its_response_a_sink():
    found = ends("sources/service_requests_rclpy.py")
    assert ("rclpy.create_service", "rclpy.Publisher.publish") in found
    assert ("rclpy.create_subscription", "rclpy.create_service.response") in found


def test_service_response_names_the_service_and_its_type():
    sink = next(f.sink for f in flows("sinks/service_and_action_results.py") if "response" in f.sink.api)
    assert (sink.topics, sink.type) == (("get_range",), "GetRange")


def test_goals_are_sources_and_results_are_sinks():
    found = ends("sources/action_goals.py")
    assert ("rclpy.action.ActionServer", "rclpy.action.ActionServer.publish_feedback") in found
    assert ("rclpy.create_subscription", "rclpy.action.ActionServer.response") in found
    found = ends("sources/simple_action_server.py")
    assert ("actionlib.SimpleActionServer", "actionlib.SimpleActionServer.set_succeeded") in found


def test_transforms_are_sources_with_the_setting_tf2():
    case = "sources/transforms_are_off.py"
    assert {f.source.api for f in flows(case)} == {"rclpy.create_subscription"}
    looked_up = [f for f in flows(case, tf2=True) if f.source.api == "tf2.lookup_transform"]
    assert {f.source.topics for f in looked_up} == {("/tf",)}
    # Each value reaches the next publish call before another one replaces it. If the first look-up fails, the callback
    # returns before its second publish call.
    assert sorted(f.kind for f in looked_up) == ["explicit", "explicit", "implicit"]


def test_services_actions_and_transforms_are_distinguished_from_topics():
    both = flows("sources/simple_action_server.py")
    assert {on_topic(f.source.api) for f in both} == {True, False}
    assert all(on_topic(f.source.api) for f in flows("state/self_attribute.py"))
