"""Parameters by prefix, ranges and their ends, logs once or at most once per period, and functions called twice."""

from __future__ import annotations

from typing import Any

import pytest

from pytest_tarl.ros.rclpy.parameter import Parameter, ParameterType
from pytest_tarl.ros.rclpy.utilities import timeout_sec_to_nsec
from tests.plugin.ros.conftest import Start

DECLARED = ("a", "a.b", "a.b.c", "ab", "d.e.f")


@pytest.mark.parametrize(
    ("prefixes", "depth", "found"),
    [
        ([], 0, DECLARED),
        ([], 1, ("a", "ab")),
        ([], 2, ("a", "a.b", "ab")),
        (["a"], 0, ("a", "a.b", "a.b.c")),
        (["a"], 1, ("a", "a.b")),
        (["a.b"], 0, ("a.b", "a.b.c")),
        (["d"], 1, ()),
        (["d"], 2, ("d.e.f",)),
        (["ab", "d"], 0, ("ab", "d.e.f")),
        (["x"], 0, ()),
    ],
)
def test_parameters_are_listed_below_their_prefixes(
    start: Start, prefixes: list[str], depth: int, found: tuple[str, ...]
) -> None:
    ros = start(f"""
        import rclpy
        rclpy.init()
        node = rclpy.create_node("n")
        for name in {DECLARED}:
            node.declare_parameter(name, 1)
        found = list(node.list_parameters({prefixes}, {depth}).names)
        below = sorted(node.get_parameters_by_prefix("a"))
    """)
    names = [one for one in ros.namespace["found"] if one != "use_sim_time"]  # type: ignore[attr-defined]
    assert tuple(names) == found
    assert ros.namespace["below"] == ["b", "b.c"]  # type: ignore[attr-defined]


@pytest.mark.parametrize(
    ("value", "reason"),
    [(-2, ""), (10, ""), (0, ""), (4, ""), (-3, "out of range"), (11, "out of range"), (1, "not a valid step"),
     (2.0, "expected 'Type.INTEGER' got 'Type.DOUBLE'")],
)  # fmt: skip
def test_whole_numbers_stay_on_their_range_steps(start: Start, value: Any, reason: str) -> None:
    said = _set(start, "integer_range=[IntegerRange(from_value=-2, to_value=10, step=2)]", "0", value)
    assert reason in said
    assert bool(reason) is bool(said)


@pytest.mark.parametrize(
    ("value", "reason"),
    [(-1.0, ""), (1.0, ""), (0.5, ""), (0.500000001, ""), (-1.001, "out of range"), (1.001, "out of range"),
     (0.3, "not close enough to a valid step")],
)  # fmt: skip
def test_numbers_stay_within_their_range_and_near_its_steps(start: Start, value: float, reason: str) -> None:
    ranged = "floating_point_range=[FloatingPointRange(from_value=-1.0, to_value=1.0, step=0.5)]"
    said = _set(start, ranged, "0.0", value)
    assert reason in said
    assert bool(reason) is bool(said)


def _set(start: Start, ranged: str, first: str, value: Any) -> str:
    ros = start(f"""
        import rclpy
        from rcl_interfaces.msg import FloatingPointRange, IntegerRange, ParameterDescriptor
        from rclpy.parameter import Parameter
        rclpy.init()
        node = rclpy.create_node("n")
        node.declare_parameter("x", {first}, ParameterDescriptor({ranged}))
        result = node.set_parameters([Parameter("x", value={value!r})])[0]
        now = node.get_parameter("x").value
    """)
    result = ros.namespace["result"]  # type: ignore[attr-defined]
    now: Any = ros.namespace["now"]  # type: ignore[attr-defined]
    assert now == (value if result.successful else 0)
    assert result.successful is not bool(result.reason)
    return str(result.reason)


@pytest.mark.parametrize(
    ("value", "kind"),
    [
        (None, ParameterType.NOT_SET),
        (True, ParameterType.BOOL),
        (1, ParameterType.INTEGER),
        (1.0, ParameterType.DOUBLE),
        ("x", ParameterType.STRING),
        ([True], ParameterType.BOOL_ARRAY),
        ([1, 2], ParameterType.INTEGER_ARRAY),
        ([1.0], ParameterType.DOUBLE_ARRAY),
        (["x"], ParameterType.STRING_ARRAY),
        ([], ParameterType.BYTE_ARRAY),
    ],
)
def test_a_parameter_has_the_type_of_its_value(value: Any, kind: ParameterType) -> None:
    parameter = Parameter("x", value=value)
    assert (parameter.type_, parameter.type, parameter.value) == (kind, kind, value)
    assert Parameter("x", kind, value).type_ == kind
    again = Parameter.from_parameter_msg(parameter.to_parameter_msg())
    assert (again.name, again.type_) == ("x", kind)
    assert (again.value or value) == value


def test_type_and_value_agree_except_for_an_empty_list() -> None:
    assert Parameter("x", ParameterType.DOUBLE_ARRAY, []).type_ == ParameterType.DOUBLE_ARRAY
    assert Parameter("x", ParameterType.DOUBLE).type_ == ParameterType.DOUBLE
    for kind, value in ((ParameterType.DOUBLE, 1), (ParameterType.DOUBLE_ARRAY, [1])):
        with pytest.raises(ValueError, match="do not agree"):
            Parameter("x", kind, value)
    for wrong in ([1, "x"], {"a": 1}, object()):
        with pytest.raises(TypeError, match="not one of the allowed types"):
            Parameter("x", value=wrong)


def test_timeouts_are_converted_to_nanoseconds() -> None:
    assert [timeout_sec_to_nsec(one) for one in (None, -0.1, 0, 0.5, 2)] == [
        -1,
        -1,
        0,
        500_000_000,
        2_000_000_000,
    ]


LOOP = """
    import {library}
    {begin}
    for turn in range(6):
        {log}
        {sleep}
"""


@pytest.mark.parametrize(
    ("log", "turns"),
    [
        ("rospy.loginfo_once('%d', turn)", "0"),
        ("rospy.logwarn_throttle(1.0, str(turn))", "024"),
        ("rospy.logwarn_throttle(1.001, str(turn))", "03"),
        ("rospy.logwarn_throttle(0, str(turn))", "012345"),
        ("rospy.logerr_throttle_identical(9, str(turn % 2))", "01"),
        ("rospy.logfatal_throttle(0.5, str(turn))", "012345"),
    ],
)
def test_rospy_logs_once_or_at_most_once_per_period(
    start: Start, caplog: pytest.LogCaptureFixture, log: str, turns: str
) -> None:
    caplog.set_level("DEBUG", "rosout")
    start(LOOP.format(library="rospy", begin="rospy.init_node('n')", log=log, sleep="rospy.sleep(0.5)")).step(
        4
    )
    assert "".join(one.getMessage() for one in caplog.records if one.name == "rosout") == turns


@pytest.mark.parametrize(
    ("options", "turns"),
    [
        ("", "012345"),
        ("once=True", "0"),
        ("skip_first=True", "12345"),
        ("throttle_duration_sec=1.0", "024"),
        ("throttle_duration_sec=1.001", "03"),
        ("throttle_duration_sec=0.0", "012345"),
        ("skip_first=True, throttle_duration_sec=1.0", "135"),
    ],
)
def test_logging_options_limit_repeated_messages(
    start: Start, caplog: pytest.LogCaptureFixture, options: str, turns: str
) -> None:
    caplog.set_level("DEBUG", "rclpy")
    begin = "rclpy.init(); node = rclpy.create_node('n')"
    log = f"node.get_logger().info(str(turn), {options})"
    sleep = "node.get_clock().sleep_for(rclpy.duration.Duration(seconds=0.5))"
    start(LOOP.format(library="rclpy", begin=begin, log=log, sleep=sleep)).step(4)
    assert "".join(one.getMessage() for one in caplog.records if one.name == "rclpy.n") == turns


def test_nodes_may_be_initialised_and_shut_down_twice(start: Start) -> None:
    ros = start("""
        import rclpy
        found = []
        for _ in range(2):
            rclpy.init()
            rclpy.get_default_context().on_shutdown(lambda: found.append("down"))
            found.append(rclpy.ok())
            rclpy.try_shutdown()
            found.append(rclpy.ok())
            rclpy.try_shutdown()
        rclpy.init()
        for function in (rclpy.init, rclpy.shutdown, rclpy.shutdown):
            try:
                function()
            except RuntimeError as error:
                found.append(str(error))
    """)
    once, down = (
        "Context.init() must only be called once",
        "Context must be initialized before it can be shutdown",
    )
    assert ros.namespace["found"] == [*[True, "down", False] * 2, once, down]  # type: ignore[attr-defined]


def test_rospy_may_be_initialised_again_with_its_name(start: Start) -> None:
    ros = start("""
        import rospy
        rospy.init_node("n")
        rospy.init_node("n")
        rospy.init_node("other", anonymous=True)
        found = [rospy.get_name(), rospy.get_namespace()]
        try:
            rospy.init_node("other")
        except rospy.ROSException as error:
            found.append(str(error))
        rospy.on_shutdown(lambda: found.append("hook"))
        rospy.signal_shutdown("a")
        rospy.signal_shutdown("b")
        found.append(rospy.is_shutdown())
    """)
    said = "rospy.init_node() has already been called with different arguments: /n"
    assert ros.namespace["found"] == ["/n", "/", said, "hook", True]  # type: ignore[attr-defined]


def test_a_namespace_has_a_slash_at_both_ends(start: Start) -> None:
    ros = start(
        "import rospy; rospy.init_node('n'); found = rospy.get_namespace(), rospy.get_name()",
        argv=("__ns:=/r",),
    )
    assert ros.namespace["found"] == ("/r/", "/r/n")  # type: ignore[attr-defined]


def test_terminal_read_ends_at_the_size_or_line_end(start: Start) -> None:
    ros = start("""
        import sys, rospy
        rospy.init_node("n")
        found = [sys.stdin.read(2), sys.stdin.readline(), sys.stdin.readline(3), sys.stdin.readline(-1)]
        found.append(sys.stdin.read(0))
    """)
    ros.type("abcd\nefgh\n")
    ros.step(0.1)
    assert ros.namespace["found"] == ["ab", "cd\n", "efg", "h\n", ""]  # type: ignore[attr-defined]
