"""Recognise published messages that are commands to move or drive something, by their type or by the topic's name."""

from __future__ import annotations

from typing import Final

from tarl_lint.name_words import words

# types that are used for commands only
COMMANDS: Final = frozenset(
    ["Twist", "TwistStamped", "AckermannDrive", "AckermannDriveStamped", "Wrench", "WrenchStamped", "AttitudeTarget",
     "PositionTarget", "GlobalPositionTarget", "ManualControl", "OverrideRCIn", "ActuatorControl", "Actuators",
     "JointTrajectory", "JointTrajectoryPoint", "MultiDOFJointTrajectory", "JointJog", "MotorSpeeds"]
)  # fmt: skip
_NUMBERS: Final = frozenset(
    [f"{kind}{form}" for kind in ("Float32", "Float64", "Int8", "Int16", "Int32", "UInt8", "UInt16", "UInt32")
     for form in ("", "MultiArray")]
)  # fmt: skip
# words of the last two parts of a topic's name
_COMMANDED: Final = frozenset(
    ["cmd", "cmds", "command", "commands", "setpoint", "setpoints", "target", "desired", "reference", "throttle",
     "thrust", "effort", "torque", "steer", "steering", "brake", "pwm", "duty", "rudder"]
)  # fmt: skip
_MEASURED: Final = frozenset(
    ["state", "states", "status", "measured", "actual", "feedback", "estimate", "estimated", "error", "sensor",
     "encoder", "reading", "level", "debug", "monitor", "plot", "distance", "bearing", "count", "percent", "limit",
     "echo", "observed", "score", "confidence", "id"]
)  # fmt: skip


def is_command(kind: str, topics: tuple[str, ...]) -> bool:
    """Return whether messages of a type are commands on one of these topics.

    Numbers are commands if the name of the topic has a word such as *command* or *thrust*, and no word such as
    *state*.
    """
    return kind in COMMANDS or (kind in _NUMBERS and any(map(_commanded, topics)))


def _commanded(topic: str) -> bool:
    named = words("/".join(topic.split("/")[-2:]))
    return not named.isdisjoint(_COMMANDED) and named.isdisjoint(_MEASURED)
