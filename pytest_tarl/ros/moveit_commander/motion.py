"""Motions of moveit_commander: straight lines in joint space, executed as by MoveIt's fake controllers."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any, Final

from pytest_tarl.ros.messages import class_of
from pytest_tarl.ros.moveit_commander.robot_model import RobotModel, described
from pytest_tarl.ros.process import Process, current_process
from pytest_tarl.ros.rospy.parameters import get_param
from pytest_tarl.ros.rospy.timing import Duration, Time, sleep
from pytest_tarl.ros.rospy.topics import Publisher, Subscriber

FAKE: Final = "move_group/fake_controller_joint_states"
_PERIOD: Final = 0.1  # seconds between the points of a trajectory
_MODELLED: Final = (
    "moveit_commander: motions are straight lines in joint space at the speed limits of the joints, published on "
    f"{FAKE}, as by MoveIt's fake controllers; obstacles and accelerations are not considered."
)
UNDESCRIBED: Final = (
    "robot_description and robot_description_semantic are not set: pass the texts of the URDF and the SRDF in "
    "parameters"
)


class Motions:
    """The robot of a process: its model, and the state of its joints, from `joint_states` or the last motion."""

    def __init__(self, process: Process) -> None:
        self._process = process
        self._models: dict[str, RobotModel | None] = {}
        self._state: dict[str, float] = {}
        self._told: set[str] = set()
        self.stopped = False
        kind = class_of("ros1", "sensor_msgs/JointState")
        self._publisher = Publisher(FAKE, kind, queue_size=10)
        self._subscriber = Subscriber("joint_states", kind, self._heard)

    @classmethod
    def here(cls) -> Motions:
        """Return the motions of the running node."""
        return current_process("moveit_commander").part(cls)

    def model(self, description: str) -> RobotModel | None:
        """Return the robot in the description; without one, add a note for the user and return None."""
        if description not in self._models:
            names = (description, f"{description}_semantic")
            self._models[description] = described({one: get_param(one, None) for one in names}, description)
        model = self._models[description]
        self._tell(
            _MODELLED if model is not None else f"moveit_commander: every plan fails, because {UNDESCRIBED}."
        )
        return model

    def state(self, model: RobotModel | None) -> dict[str, float]:
        """Return the values of all joints; 0 for a joint without a received value."""
        names = model.joints if model is not None else ()
        return {name: self._state.get(name, 0.0) for name in names}

    def run(self, trajectory: Any) -> bool:
        """Publish each state of a trajectory when it is due; return False if the motion is stopped."""
        began, self.stopped = Time.now(), False
        for point in trajectory.points:
            wait = (began + point.time_from_start - Time.now()).to_sec()
            if wait > 0:
                sleep(wait)
            if self.stopped:
                return False
            self._state.update(zip(trajectory.joint_names, point.positions, strict=True))
            message: Any = class_of("ros1", "sensor_msgs/JointState")()
            message.header.stamp = Time.now()
            message.name, message.position = list(trajectory.joint_names), list(point.positions)
            self._publisher.publish(message)
        return True

    def begin(self, trajectory: Any) -> None:
        """Run a trajectory in the background."""
        self._process.scheduler.spawn(self._process, self.run, trajectory)

    def _heard(self, message: Any) -> None:
        self._state.update(zip(message.name, message.position, strict=False))

    def _tell(self, note: str) -> None:
        tell = getattr(self._process.ros, "note", None)
        if note not in self._told and tell is not None:
            self._told.add(note)
            tell(note)


def straight(
    model: RobotModel, start: Mapping[str, float], goals: Sequence[Mapping[str, float]], share: float
) -> Any:
    """Return a JointTrajectory through joint values, at the share `share` of the joints' speed limits."""
    names = list(goals[0]) if goals else []
    trajectory: Any = class_of("ros1", "trajectory_msgs/JointTrajectory")()
    trajectory.header.frame_id, trajectory.joint_names = model.planning_frame, names
    here, moment = {name: start[name] for name in names}, 0.0
    trajectory.points = [_point(here, names, moment, dict.fromkeys(names, 0.0))]
    for goal in goals:
        needed = max(
            (abs(goal[name] - here[name]) / (model.speed(name) * share) for name in names), default=0.0
        )
        steps = math.ceil(needed / _PERIOD - 1e-9)
        speeds = {name: (goal[name] - here[name]) / needed if needed else 0.0 for name in names}
        for step in range(1, steps + 1):
            part = step / steps
            between = {name: here[name] + part * (goal[name] - here[name]) for name in names}
            trajectory.points.append(_point(between, names, moment + part * needed, speeds))
        here, moment = dict(goal), moment + needed
    trajectory.points[-1].velocities = [0.0] * len(names)
    return trajectory


def _point(
    values: Mapping[str, float], names: Sequence[str], moment: float, speeds: Mapping[str, float]
) -> Any:
    point: Any = class_of("ros1", "trajectory_msgs/JointTrajectoryPoint")()
    point.positions = [float(values[name]) for name in names]
    point.velocities = [float(speeds[name]) for name in names]
    point.accelerations = [0.0] * len(names)
    point.time_from_start = Duration(moment)
    return point
