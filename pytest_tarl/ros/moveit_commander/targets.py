"""The targets and settings of a move group."""

from __future__ import annotations

import random
from collections.abc import Mapping, Sequence
from typing import Any

from pytest_tarl.ros.kdl.frames import Frame
from pytest_tarl.ros.kdl.rotations import Rotation
from pytest_tarl.ros.kdl.vectors import Vector
from pytest_tarl.ros.messages import class_of
from pytest_tarl.ros.moveit_commander.conversions import list_to_pose, rpy_of
from pytest_tarl.ros.moveit_commander.exception import MoveItCommanderException
from pytest_tarl.ros.moveit_commander.motion import UNDESCRIBED, Motions
from pytest_tarl.ros.moveit_commander.robot_model import Group, RobotModel
from pytest_tarl.ros.posemath import fromMsg


class Targets:
    """A robot's group of joints, with its current state and its target."""

    def __init__(self, name: str, description: str) -> None:
        self._motions = Motions.here()
        self._model: RobotModel | None = self._motions.model(description)
        groups = self._model.groups if self._model is not None else {name: Group(name, (), ())}
        if name not in groups:
            raise RuntimeError(f"Group '{name}' was not found.")
        self._group = groups[name]
        self._tip, self._frame = self._group.tip, ""
        self._goal: dict[str, float] | None = None  # joint values
        self._pose: tuple[str, Any] | None = None  # the link to move, and its PoseStamped
        self._start: dict[str, float] | None = None  # joint values; None to plan from the current state
        self._kept: dict[str, list[float]] = {}
        self._random = random.Random(name)

    def get_name(self) -> str:
        """Return the name of the group."""
        return self._group.name

    def get_joints(self) -> list[str]:
        """Return the moving joints."""
        return list(self._group.joints)

    get_active_joints = get_joints

    def get_variable_count(self) -> int:
        """Return the number of joint values."""
        return len(self._group.joints)

    def get_link_names(self) -> list[str]:
        """Return the links."""
        return list(self._group.links)

    def has_end_effector_link(self) -> bool:
        """Return whether poses have a link."""
        return bool(self._tip)

    def get_end_effector_link(self) -> str:
        """Return the link that poses apply to."""
        return self._tip

    def set_end_effector_link(self, link_name: str) -> None:
        """Set the link that poses apply to. Raise MoveItCommanderException for an unknown link."""
        if self._model is not None and link_name not in self._model.robot.link_map:
            raise MoveItCommanderException("Unable to set end effector link")
        self._tip = link_name

    def get_planning_frame(self) -> str:
        """Return the frame of the robot."""
        return self._model.planning_frame if self._model is not None else ""

    def get_pose_reference_frame(self) -> str:
        """Return the frame of poses without a header."""
        return self._frame or self.get_planning_frame()

    def set_pose_reference_frame(self, reference_frame: str) -> None:
        """Set the frame of poses without a header."""
        self._frame = reference_frame

    def get_current_joint_values(self) -> list[float]:
        """Return the current joint values."""
        return self._values(self._now())

    def get_current_state(self) -> Any:
        """Return the current joint values of the whole robot as a RobotState."""
        state: Any = class_of("ros1", "moveit_msgs/RobotState")()
        now = self._motions.state(self._model)
        state.joint_state.header.frame_id = self.get_planning_frame()
        state.joint_state.name, state.joint_state.position = list(now), list(now.values())
        return state

    def get_current_pose(self, end_effector_link: str = "") -> Any:
        """Return the current pose of a link. Raise MoveItCommanderException without a link."""
        return self._stamped(self._link(end_effector_link), self._now())

    def get_current_rpy(self, end_effector_link: str = "") -> list[float]:
        """Return roll, pitch and yaw of a link."""
        return rpy_of(self.get_current_pose(end_effector_link).pose)

    def get_random_joint_values(self) -> list[float]:
        """Return joint values within the limits; a new group draws the same ones in every run."""
        bounds = [self._model.bounds(one) if self._model else None for one in self._group.joints]
        return [self._random.uniform(*(one or (-3.14, 3.14))) for one in bounds]

    def get_random_pose(self, end_effector_link: str = "") -> Any:
        """Return a link's pose at random joint values."""
        values = dict(zip(self._group.joints, self.get_random_joint_values(), strict=True))
        return self._stamped(self._link(end_effector_link), {**self._now(), **values})

    def set_start_state_to_current_state(self) -> None:
        """Plan from the current state."""
        self._start = None

    def set_start_state(self, msg: Any) -> None:
        """Plan from a RobotState."""
        self._start = dict(zip(msg.joint_state.name, msg.joint_state.position, strict=True))

    def set_joint_value_target(self, arg1: Any, arg2: Any = None, arg3: Any = None) -> None:
        """Set joint values as the target: a list, a mapping, a JointState, a name with a value, or a pose.

        Raise MoveItCommanderException for unknown names, a wrong number of values, or values beyond the limits.
        """
        kind = type(arg1).__name__
        if kind in ("Pose", "PoseStamped"):
            self._set_by_pose(arg1, arg2, arg3)
            return
        if kind == "RobotState":
            arg1, kind = arg1.joint_state, "JointState"
        if kind == "JointState":
            given = dict(zip(arg1.name, arg1.position, strict=True))
        elif isinstance(arg1, Mapping):
            given = {str(name): float(value) for name, value in arg1.items()}
        elif isinstance(arg1, str):
            given = {arg1: float(arg2)}
        elif len(arg1) != len(self._group.joints):
            why = f" ({UNDESCRIBED})" if self._model is None else ""
            raise MoveItCommanderException(f"Error setting joint target. Is the target within bounds?{why}")
        else:
            given = dict(zip(self._group.joints, map(float, arg1), strict=True))
        self._set_goal(
            {
                name: value
                for name, value in given.items()
                if kind != "JointState" or name in self._group.joints
            }
        )

    def _set_by_pose(self, pose: Any, link: Any, approximate: Any) -> None:
        if isinstance(link, bool):
            link, approximate = "", link
        found = self._joints_at(self._link(link or ""), self._posed(pose))
        if found is None:
            what = "approximate" if approximate else "exact"
            raise MoveItCommanderException(
                f"Error setting joint target. Does your IK solver support {what} IK?"
            )
        self._set_goal(found)

    def _set_goal(self, given: Mapping[str, float]) -> None:
        if not set(given) <= set(self._group.joints) or (self._model and not self._model.allowed(given)):
            raise MoveItCommanderException("Error setting joint target. Is the target within bounds?")
        self._goal, self._pose = {**(self._goal or self._now()), **given}, None

    def get_joint_value_target(self) -> list[float]:
        """Return the target's joint values."""
        return self._values(self._goal or self._now())

    def set_named_target(self, name: str) -> None:
        """Set the target: a state from the semantic description, or remembered values.

        Raise MoveItCommanderException for an unknown name.
        """
        if name in self._kept:
            self._set_goal(dict(zip(self._group.joints, self._kept[name], strict=True)))
        elif name in self._group.states:
            self._set_goal({k: v for k, v in self._group.states[name].items() if k in self._group.joints})
        else:
            raise MoveItCommanderException(f"Unable to set target {name}. Is the target within bounds?")

    def get_named_targets(self) -> list[str]:
        """Return the names of the semantic description's states and of the remembered values."""
        return [*self._group.states, *self._kept]

    def get_named_target_values(self, target: str) -> dict[str, float]:
        """Return the joint values of a named state."""
        return dict(self._group.states.get(target, {}))

    def remember_joint_values(self, name: str, values: Sequence[float] | None = None) -> None:
        """Remember joint values (by default, the current ones) as a named target."""
        self._kept[name] = list(values) if values is not None else self.get_current_joint_values()

    def get_remembered_joint_values(self) -> dict[str, list[float]]:
        """Return the remembered values by name."""
        return dict(self._kept)

    def forget_joint_values(self, name: str) -> None:
        """Forget remembered values."""
        self._kept.pop(name, None)

    def set_random_target(self) -> None:
        """Set random joint values as the target."""
        self._set_goal(dict(zip(self._group.joints, self.get_random_joint_values(), strict=True)))

    def set_pose_target(self, pose: Any, end_effector_link: str = "") -> None:
        """Set a link's target pose: a Pose, a PoseStamped, or a list of 6 or 7 numbers."""
        self._pose = self._link(end_effector_link), self._posed(pose)
        self._goal = None

    def set_pose_targets(self, poses: Sequence[Any], end_effector_link: str = "") -> None:
        """Set target poses, of which only the first is used."""
        self.set_pose_target(poses[0], end_effector_link)

    def set_position_target(self, xyz: Sequence[float], end_effector_link: str = "") -> None:
        """Set a link's target position; its orientation stays."""
        pose = self.get_current_pose(end_effector_link)
        pose.pose.position.x, pose.pose.position.y, pose.pose.position.z = map(float, xyz)
        self.set_pose_target(pose, end_effector_link)

    def set_orientation_target(self, q: Sequence[float], end_effector_link: str = "") -> None:
        """Set a link's target quaternion; its position stays."""
        pose = self.get_current_pose(end_effector_link)
        turn = pose.pose.orientation
        turn.x, turn.y, turn.z, turn.w = map(float, q)
        self.set_pose_target(pose, end_effector_link)

    def set_rpy_target(self, rpy: Sequence[float], end_effector_link: str = "") -> None:
        """Set a link's target roll, pitch and yaw; its position stays."""
        self.set_orientation_target(Rotation.RPY(*rpy).GetQuaternion(), end_effector_link)

    def shift_pose_target(self, axis: int, value: float, end_effector_link: str = "") -> None:
        """Set the current pose as the target, after changing x, y, z, roll, pitch or yaw (axis 0 to 5)."""
        pose = self.get_current_pose(end_effector_link)
        numbers = [*fromMsg(pose.pose).p, *rpy_of(pose.pose)]
        numbers[axis] += value
        pose.pose = list_to_pose(numbers)
        self.set_pose_target(pose, end_effector_link)

    def clear_pose_target(self, end_effector_link: str = "") -> None:  # noqa: ARG002
        """Remove the target pose."""
        self._pose = None

    def clear_pose_targets(self) -> None:
        """Remove the target pose."""
        self._pose = None

    def _joints_at(self, link: str, stamped: Any) -> dict[str, float] | None:
        """Return joint values for a pose, or None. The pose's frame may be a link of the robot."""
        if self._model is None:
            return None
        frame, pose = stamped.header.frame_id.lstrip("/"), fromMsg(stamped.pose)
        if frame not in ("", self._model.root, self._model.planning_frame):
            if frame not in self._model.robot.link_map:
                return None
            pose = self._model.pose(frame, self._now()) * pose
        start = {**self._now(), **(self._start or {})}
        return self._model.reached(self._group, link, pose, start)

    def _now(self) -> dict[str, float]:
        return self._motions.state(self._model)

    def _values(self, state: Mapping[str, float]) -> list[float]:
        return [state[one] for one in self._group.joints]

    def _link(self, named: str) -> str:
        if not named and not self._tip:
            why = f" ({UNDESCRIBED})" if self._model is None else ""
            raise MoveItCommanderException(f"There is no end effector to get the pose of{why}")
        return named or self._tip

    def _stamped(self, link: str, state: Mapping[str, float]) -> Any:
        from pytest_tarl.ros.rospy.timing import Time

        stamped: Any = class_of("ros1", "geometry_msgs/PoseStamped")()
        stamped.header.frame_id, stamped.header.stamp = self.get_planning_frame(), Time.now()
        pose = self._model.pose(link, state) if self._model is not None else Frame()
        place, turn = stamped.pose.position, stamped.pose.orientation
        place.x, place.y, place.z = pose.p
        turn.x, turn.y, turn.z, turn.w = pose.M.GetQuaternion()
        return stamped

    def _posed(self, pose: Any) -> Any:
        """Return a pose as a PoseStamped."""
        if hasattr(pose, "header"):
            return pose
        stamped: Any = class_of("ros1", "geometry_msgs/PoseStamped")()
        stamped.header.frame_id = self.get_pose_reference_frame()
        stamped.pose = pose if hasattr(pose, "position") else list_to_pose(pose)
        return stamped


def along(one: Frame, other: Frame, part: float) -> Frame:
    """Return the frame at the share `part` of the way from one frame to another."""
    angle, axis = (one.M.Inverse() * other.M).GetRotAngle()
    place: Vector = one.p + part * (other.p - one.p)
    return Frame(one.M * Rotation.Rot(axis, part * angle), place)
