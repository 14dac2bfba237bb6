"""TARL202: a command follows a sensor without limit.

The program computes a command for actuators, such as a velocity, a throttle or an angle, from a number in a received
message, and nothing bounds this number. Sensors sometimes send infinity, jumps or invalid values, and the command
follows them. Clamp the value at the reported line, where it is computed: with `min`, `max` or `clip`, with a function
whose result is bounded (`sin`, `atan2`), or with a comparison that replaces values that are too large.

A condition that only checks whether a value is large enough (`while distance > tolerance`) does not bound the value
from above.

Messages such as `LaserScan`, `Odometry` and `Imu` count as sensor data. A plain number counts as sensor data if the
name of its topic suggests it (`/range`, `/cte`). The rule does not report

- values of other messages, such as commands, goals and parameters, because a person or a planner may have chosen them,
- values that pass through code outside the analysed files,
- speeds that may be measurements, such as a Float64 on `/speed` that is computed from ticks, from `twist`, or from a
  distance and a time.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from typing import Final

from tarl_lint.catalog import on_topic
from tarl_lint.evidence import Evidence
from tarl_lint.fingerprints import topic_text
from tarl_lint.model import Finding, Flow, Sink, Source, Span
from tarl_lint.models.ros.endpoints import SinkRecord, SourceRecord
from tarl_lint.prefilter.one_sided_groups import Side
from tarl_lint.rules.limits.unbounded import Magnitudes
from tarl_lint.rules.wording import end

CODE: Final = "TARL202"
SUMMARY: Final = "a command follows a sensor without limit"

INVALID: Final = (
    """
    import math
    import rospy
    from geometry_msgs.msg import Twist
    from nav_msgs.msg import Odometry

    class GoTo:
        def __init__(self):
            self.x = self.y = 0.0
            self.pub = rospy.Publisher("/cmd_vel", Twist, queue_size=1)
            rospy.Subscriber("/odom", Odometry, self.on_odom)

        def on_odom(self, msg):
            self.x = msg.pose.pose.position.x
            self.y = msg.pose.pose.position.y

        def go(self, x, y):
            distance = math.hypot(x - self.x, y - self.y)
            while distance > 0.1:
                distance = math.hypot(x - self.x, y - self.y)
                cmd = Twist()
                cmd.linear.x = 0.8 * distance
                self.pub.publish(cmd)
                rospy.sleep(0.1)

    GoTo().go(1.0, 2.0)
    """,
)

VALID: Final = (
    """
    import rospy
    from geometry_msgs.msg import Twist
    from sensor_msgs.msg import Range

    pub = rospy.Publisher("/cmd_vel", Twist, queue_size=1)

    def on_range(msg):
        cmd = Twist()
        cmd.linear.x = min(0.5, 0.3 * msg.range)
        pub.publish(cmd)

    rospy.Subscriber("/range", Range, on_range)
    """,
    """
    import rospy
    from geometry_msgs.msg import Twist
    from sensor_msgs.msg import Range

    LIMIT = 0.5
    pub = rospy.Publisher("/cmd_vel", Twist, queue_size=1)

    def on_range(msg):
        speed = 0.3 * msg.range
        if speed > LIMIT:
            speed = LIMIT
        cmd = Twist()
        cmd.linear.x = speed
        pub.publish(cmd)

    rospy.Subscriber("/range", Range, on_range)
    """,
    """
    import rospy
    from sensor_msgs.msg import Range
    from std_msgs.msg import Float64

    pub = rospy.Publisher("/distance_in_feet", Float64, queue_size=1)

    def on_range(msg):
        pub.publish(3.28 * msg.range)

    rospy.Subscriber("/range", Range, on_range)
    """,
    """
    import rospy
    from std_msgs.msg import Float64, Int64

    pub = rospy.Publisher("/wheel_speed", Float64, queue_size=1)
    last = 0

    def on_ticks(msg):
        global last
        pub.publish(0.01 * (msg.data - last))
        last = msg.data

    rospy.Subscriber("/ticks", Int64, on_ticks)
    """,
)

COMMAND_TYPES: Final = re.compile(r"^(Ackermann\w*|\w*(Cmd|Command|Control|Thrust)\w*)$")
# Nodes also publish measurements with these types, so the name of the topic must contain a word for a command.
PLAIN_TYPES: Final = frozenset(
    ["Float32", "Float64", "Int16", "Int32", "Int64", "Twist", "TwistStamped", "Wrench", "WrenchStamped"]
)
COMMAND_TOPICS: Final = re.compile(
    r"cmd|command|ctrl|control|steer|throttle|brake|effort|torque|thrust|motor|servo|pwm|setpoint|teleop|drive|mux",
    re.I,
)
SPEED_TOPICS: Final = re.compile(r"vel|speed", re.I)
PLACE_TYPES: Final = frozenset(
    ["Odometry", "Pose", "PoseStamped", "PoseWithCovarianceStamped", "Pose2D", "Point", "PointStamped", "LaserScan",
     "Range", "PointCloud2"]
)  # fmt: skip
SPEEDS: Final = re.compile(
    r"\.twist\b|/\s*\(?\s*[\w.]*(dt|time|elapsed|duration|period|now|stamp|to_sec)", re.I
)
NO_COMMAND: Final = re.compile(
    r"estimat|measur|actual|current|state|feedback|error|odom|debug|filter|status", re.I
)
SENSOR_TYPES: Final = frozenset(
    ["LaserScan", "MultiEchoLaserScan", "Range", "PointCloud", "PointCloud2", "Imu", "Odometry", "NavSatFix",
     "MagneticField", "FluidPressure", "Temperature", "RelativeHumidity", "Illuminance", "BatteryState", "JointState",
     "ContactsState", "ModelStates", "LinkStates", "DepthSensor", "AMCLPose", "Pose", "PoseStamped",
     "PoseWithCovariance", "PoseWithCovarianceStamped", "Pose2D", "Point", "PointStamped", "TransformStamped"]
)  # fmt: skip
NUMBERS: Final = re.compile(
    r"^(Float(32|64)|U?Int(16|32|64))(MultiArray)?$|^(Vector3|Wrench|Accel|Quaternion)(Stamped)?$"
)
SENSOR_TOPICS: Final = re.compile(
    r"range|dist|sonar|lidar|laser|scan|imu|gyro|accel|odom|encoder|tick|yaw|heading|compass|depth|altitude|height|gps"
    r"|temperature|pressure|force|weight|position|pose|tilt|angle|offset|deviation|cte|error|light|sensor|measur|detect"
    r"|track|state",
    re.I,
)
ASKED_FOR: Final = re.compile(
    r"cmd|command|setpoint|set_point|target|goal|desired|wish|reference|joy|teleop|key|param|request|plan|waypoint|mode"
    r"|drive|control|ctrl|throttle|steer",
    re.I,
)  # names of topics that carry decisions, not measurements


def ruled_out(side: Side) -> bool:  # noqa: ARG001 - shared signature
    """Return True: a command that follows a sensor is a flow, and a one-sided group has no flow."""
    return True


def findings(evidence: Evidence) -> Iterator[Finding]:
    """Yield a hazard for each statement that computes an unlimited part of a command."""
    pairs = {(f.source, f.sink) for f in evidence.flows if f.kind == "explicit" and _hazardous(f)}
    if not pairs:
        return
    found: dict[Span, tuple[set[Source], set[Sink]]] = {}
    ends = evidence.tracer.ends
    calls = [(record, ends.sink(record)) for record in evidence.tracer.sinks]
    for origin in evidence.tracer.sources:
        source = ends.source(origin)
        records = [record for record, sink in calls if (source, sink) in pairs]
        if records:
            _add(found, evidence, origin, records)
    for span, (sources, sinks) in found.items():
        commands, sensors = _joined(map(end, sinks)), _joined(map(end, sources))
        topics = (_joined(topic_text(e.topics) for e in ends) for ends in (sources, sinks))
        message = f"{commands} follows {sensors} without limit: clamp this value"
        yield evidence.finding(CODE, span, message, " → ".join(topics))


def _joined(names: Iterable[str]) -> str:
    return ", ".join(sorted(set(names)))


def _add(
    found: dict[Span, tuple[set[Source], set[Sink]]],
    evidence: Evidence,
    origin: SourceRecord,
    records: list[SinkRecord],
) -> None:
    magnitudes = Magnitudes(evidence, origin)
    for record in records:
        for place in magnitudes.computed(record):
            sources, commands = found.setdefault(place, (set(), set()))
            sources.add(evidence.tracer.ends.source(origin))
            commands.add(evidence.tracer.ends.sink(record))


def _hazardous(flow: Flow) -> bool:
    """Return whether the flow leads from sensor data to a command for actuators."""
    return _sensor(flow.source) and _command(flow)


def _sensor(source: Source) -> bool:
    """Return whether a source is a sensor, judged by its message type or, for plain numbers, by its topic."""
    if not on_topic(source.api) or not ("ubscri" in source.api or "wait_for_message" in source.api):
        return False
    types = (source.type or "").split(" | ")
    if any(map(ASKED_FOR.search, (*source.topics, *types))):
        return False
    if set(types) <= SENSOR_TYPES:
        return True
    numbers = all(t in SENSOR_TYPES or NUMBERS.match(t) for t in types)
    return numbers and any(map(SENSOR_TOPICS.search, source.topics))


def _command(flow: Flow) -> bool:
    """Return whether the published message is a command for actuators."""
    sink, topic = flow.sink, ", ".join(flow.sink.topics)
    if not on_topic(sink.api) or NO_COMMAND.search(topic):
        return False
    types = sink.type.split(" | ")
    if any(map(COMMAND_TYPES.match, types)):
        return True
    if not PLAIN_TYPES & set(types):
        return False
    return bool(COMMAND_TOPICS.search(topic)) or (bool(SPEED_TOPICS.search(topic)) and not _measured(flow))


def _measured(flow: Flow) -> bool:
    """Return whether a speed may be a measurement: from speeds or ticks, or a distance divided by a time."""
    code = " ".join(step.code for step in flow.steps if step.dependence == "data")
    return not PLACE_TYPES & set((flow.source.type or "").split(" | ")) or bool(SPEEDS.search(code))
