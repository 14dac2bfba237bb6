"""`MoveGroupCommander`: plans straight lines in joint space, and executes them in virtual time."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, Final

from pytest_tarl.ros.messages import class_of
from pytest_tarl.ros.missing import unsupported_name
from pytest_tarl.ros.moveit_commander.exception import MoveItCommanderException
from pytest_tarl.ros.moveit_commander.motion import straight
from pytest_tarl.ros.moveit_commander.targets import Targets, along
from pytest_tarl.ros.posemath import fromMsg
from pytest_tarl.ros.rospy.topics import Publisher

__all__ = ["MoveGroupCommander"]


SUCCESS, FAILED, NO_IK, INVALID = 1, -1, -31, -16  # moveit_msgs/MoveItErrorCodes
_SETTINGS: Final = {
    "goal_joint_tolerance": 1e-4,
    "goal_position_tolerance": 1e-4,
    "goal_orientation_tolerance": 1e-3,
    "planning_time": 5.0,
    "planner_id": "",
    "planning_pipeline_id": "",
}


class MoveGroupCommander(Targets):
    """A group of joints from `robot_description` and `robot_description_semantic`.

    Without these parameters, a group can be created, but planning fails. Settings of the planner are stored, but have
    no effect.
    """

    def __init__(
        self,
        name: str,
        robot_description: str = "robot_description",
        ns: str = "",  # noqa: ARG002
        wait_for_servers: float = 5.0,  # noqa: ARG002
    ) -> None:
        super().__init__(name, robot_description)
        self._settings: dict[str, Any] = dict(_SETTINGS)
        kind = class_of("ros1", "moveit_msgs/AttachedCollisionObject")
        self._attached = Publisher("attached_collision_object", kind, queue_size=1)
        self._share = 1.0  # share of the joints' speed limits for motions
        self._constraints: Any = class_of("ros1", "moveit_msgs/Constraints")()

    def plan(self, joints: Any = None) -> tuple[bool, Any, float, Any]:
        """Return whether there is a plan, its RobotTrajectory, the planning time (0 s) and the error code."""
        self._aim(joints)
        code, goal = self._goal_of_plan()
        trajectory: Any = class_of("ros1", "moveit_msgs/RobotTrajectory")()
        if code == SUCCESS and goal is not None and self._model is not None:
            start = {**self._now(), **(self._start or {})}
            trajectory.joint_trajectory = straight(self._model, start, [goal], self._share)
        codes: Any = class_of("ros1", "moveit_msgs/MoveItErrorCodes")()
        codes.val = code
        return code == SUCCESS, trajectory, 0.0, codes

    def go(self, joints: Any = None, wait: bool = True) -> bool:
        """Plan to the target and execute the plan; return whether the target was reached."""
        self._start = None
        succeeded, trajectory, _, _ = self.plan(joints)
        return self.execute(trajectory, wait=wait) if succeeded else False

    def execute(self, plan_msg: Any, wait: bool = True) -> bool:
        """Execute a RobotTrajectory; return whether its end was reached."""
        trajectory = plan_msg.joint_trajectory
        if not trajectory.points or self._model is None:
            return False
        if wait:
            return self._motions.run(trajectory)
        self._motions.begin(trajectory)
        return True

    def stop(self) -> None:
        """Stop the motion."""
        self._motions.stopped = True

    def compute_cartesian_path(
        self, waypoints: Sequence[Any], eef_step: float, *options: Any, **_named: Any
    ) -> tuple[Any, float]:
        """Return the link's trajectory along straight lines through poses, and the covered fraction.

        The trajectory ends at the last reachable pose. Raise MoveItCommanderException if the step is not positive.
        """
        if eef_step <= 0 or any(isinstance(one, float | int) and one < 0 for one in options[:1]):
            raise MoveItCommanderException("The step of a Cartesian path must be positive.")
        trajectory: Any = class_of("ros1", "moveit_msgs/RobotTrajectory")()
        if self._model is None:
            return trajectory, -1.0
        state, link = {**self._now(), **(self._start or {})}, self._link("")
        here, goals, steps, done = self._model.pose(link, state), [], 0, 0
        for pose in (fromMsg(getattr(one, "pose", one)) for one in waypoints):
            count = max(1, math.ceil((pose.p - here.p).Norm() / eef_step))
            steps += count
            for step in range(1, count + 1):
                found = self._model.reached(self._group, link, along(here, pose, step / count), state)
                if done < steps - count + step - 1 or found is None:
                    break
                state, done = {**state, **found}, done + 1
                goals.append({name: state[name] for name in self._group.joints})
            here = pose
        start = {**self._now(), **(self._start or {})}
        if goals:
            trajectory.joint_trajectory = straight(self._model, start, goals, self._share)
        return trajectory, done / steps if steps else 1.0

    def retime_trajectory(
        self, ref_state_in: Any, traj_in: Any, velocity_scaling_factor: float = 1.0, *_: Any, **__: Any
    ) -> Any:
        """Return a trajectory at a share of the joints' speed limits."""
        points = [dict(zip(traj_in.joint_trajectory.joint_names, one.positions, strict=True))
                  for one in traj_in.joint_trajectory.points]  # fmt: skip
        retimed: Any = class_of("ros1", "moveit_msgs/RobotTrajectory")()
        if points and self._model is not None:
            start: dict[str, float] = dict(
                zip(ref_state_in.joint_state.name, ref_state_in.joint_state.position, strict=True)
            )
            first = {name: start.get(name, float(value)) for name, value in points[0].items()}
            retimed.joint_trajectory = straight(
                self._model, first, points[1:] or points, velocity_scaling_factor
            )
        return retimed

    def _aim(self, joints: Any) -> None:
        """Set the target of `plan` and `go`: joint values, a pose, or a name."""
        if joints is None:
            return
        if isinstance(joints, str):
            self.set_named_target(joints)
        elif type(joints).__name__ in ("Pose", "PoseStamped"):
            self.set_pose_target(joints)
        else:
            self.set_joint_value_target(joints)

    def _goal_of_plan(self) -> tuple[int, dict[str, float] | None]:
        """Return an error code and the target's joint values."""
        if self._model is None:
            return FAILED, None
        if self._pose is not None:
            found = self._joints_at(*self._pose)
            return (SUCCESS, found) if found is not None else (NO_IK, None)
        if self._goal is None:
            return INVALID, None
        return SUCCESS, {name: self._goal[name] for name in self._group.joints}

    def set_max_velocity_scaling_factor(self, value: float) -> None:
        """Set the share of the speed limits. Raise MoveItCommanderException unless it is in (0, 1]."""
        if not 0 < value <= 1:
            raise MoveItCommanderException("Expected value in the range from 0 to 1 for scaling factor")
        self._share = value

    def set_max_acceleration_scaling_factor(self, value: float) -> None:
        """Raise MoveItCommanderException unless the value is in (0, 1]; accelerations are not modelled."""
        if not 0 < value <= 1:
            raise MoveItCommanderException("Expected value in the range from 0 to 1 for scaling factor")

    def get_goal_tolerance(self) -> tuple[float, float, float]:
        """Return the tolerances of joints, positions and orientations."""
        names = ("goal_joint_tolerance", "goal_position_tolerance", "goal_orientation_tolerance")
        joint, position, orientation = (self._settings[one] for one in names)
        return joint, position, orientation

    def set_goal_tolerance(self, value: float) -> None:
        """Set all tolerances."""
        for name in ("goal_joint_tolerance", "goal_position_tolerance", "goal_orientation_tolerance"):
            self._settings[name] = value

    def get_path_constraints(self) -> Any:
        """Return the constraints, which have no effect."""
        return self._constraints

    def set_path_constraints(self, value: Any) -> None:
        """Store constraints, which have no effect."""
        self._constraints = value if value is not None else class_of("ros1", "moveit_msgs/Constraints")()

    def clear_path_constraints(self) -> None:
        """Remove the constraints."""
        self.set_path_constraints(None)

    def attach_object(self, object_name: str, link_name: str = "", touch_links: Sequence[str] = ()) -> bool:
        """Publish that an object is attached to a link, which has no effect on plans; return True."""
        self._attach(object_name, link_name or self._tip, touch_links, operation=0)
        return True

    def detach_object(self, name: str = "") -> bool:
        """Publish that an object is detached; return True."""
        self._attach(name, "", (), operation=1)
        return True

    def _attach(self, name: str, link: str, touching: Sequence[str], operation: int) -> None:
        attached: Any = class_of("ros1", "moveit_msgs/AttachedCollisionObject")()
        attached.object.id, attached.object.operation = name, operation
        attached.link_name, attached.touch_links = link, list(touching)
        self._attached.publish(attached)

    def allow_replanning(self, value: bool) -> None:
        """Accept the setting, which has no effect."""

    def allow_looking(self, value: bool) -> None:
        """Accept the setting, which has no effect."""

    def set_num_planning_attempts(self, num_planning_attempts: int) -> None:
        """Accept the setting, which has no effect."""

    def set_workspace(self, ws: Sequence[float]) -> None:
        """Accept the setting, which has no effect."""

    def set_support_surface_name(self, value: str) -> None:
        """Accept the setting, which has no effect."""

    def __getattr__(self, name: str) -> Any:
        """Return the accessor of a setting, such as `get_planning_time()` or `set_planner_id("…")`."""
        action, _, setting = name.partition("_")
        settings = self.__dict__.get("_settings", {})
        if setting in settings and action == "get":
            return lambda: settings[setting]
        if setting in settings and action == "set":
            return lambda value: settings.__setitem__(setting, value)
        if name.startswith("_"):
            raise AttributeError(name)
        raise unsupported_name(f"moveit_commander.MoveGroupCommander.{name}")
