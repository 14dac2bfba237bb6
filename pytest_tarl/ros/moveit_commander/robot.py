"""`RobotCommander`: the groups, joints and links of the robot."""

from __future__ import annotations

from typing import Any

from pytest_tarl.ros.messages import class_of
from pytest_tarl.ros.moveit_commander.exception import MoveItCommanderException
from pytest_tarl.ros.moveit_commander.motion import Motions
from pytest_tarl.ros.moveit_commander.move_group import MoveGroupCommander

__all__ = ["RobotCommander"]


class RobotCommander:
    """The robot in `robot_description` and `robot_description_semantic`; without them, it has no groups."""

    def __init__(self, robot_description: str = "robot_description", ns: str = "") -> None:  # noqa: ARG002
        self._description = robot_description
        self._motions = Motions.here()
        self._model = self._motions.model(robot_description)
        self._groups: dict[str, MoveGroupCommander] = {}

    def get_planning_frame(self) -> str:
        """Return the frame of the robot."""
        return self._model.planning_frame if self._model is not None else ""

    def get_robot_name(self) -> str:
        """Return the name of the robot."""
        return str(self._model.robot.name) if self._model is not None else ""

    def get_root_link(self) -> str:
        """Return the link without a parent."""
        return self._model.root if self._model is not None else ""

    def get_group_names(self) -> list[str]:
        """Return the names of the groups."""
        return list(self._model.groups) if self._model is not None else []

    def get_default_owner_group(self, joint_name: str) -> str | None:
        """Return the smallest group that has a joint, or None."""
        groups = self._model.groups.values() if self._model is not None else ()
        owners = [one for one in groups if joint_name in one.joints]
        return min(owners, key=lambda one: len(one.joints)).name if owners else None

    def get_current_state(self) -> Any:
        """Return the current joint values as a RobotState."""
        state: Any = class_of("ros1", "moveit_msgs/RobotState")()
        now = self._motions.state(self._model)
        state.joint_state.header.frame_id = self.get_planning_frame()
        state.joint_state.name, state.joint_state.position = list(now), list(now.values())
        return state

    def get_current_variable_values(self) -> dict[str, float]:
        """Return the current joint values by name."""
        return self._motions.state(self._model)

    def get_joint_names(self, group: str | None = None) -> list[str]:
        """Return the moving joints of the robot or a group. Raise MoveItCommanderException for an unknown group."""
        if group is None:
            return list(self._model.joints) if self._model is not None else []
        return list(self._of(group).joints)

    get_active_joint_names = get_joint_names

    def get_link_names(self, group: str | None = None) -> list[str]:
        """Return the links of the robot or a group. Raise MoveItCommanderException for an unknown group."""
        if group is None:
            return list(self._model.robot.link_map) if self._model is not None else []
        return list(self._of(group).links)

    def has_group(self, name: str) -> bool:
        """Return whether there is a group of this name."""
        return name in self.get_group_names()

    def get_group(self, name: str) -> MoveGroupCommander:
        """Return a group. Raise MoveItCommanderException for an unknown one."""
        if not self.has_group(name):
            raise MoveItCommanderException(f"There is no group named {name}")
        if name not in self._groups:
            self._groups[name] = MoveGroupCommander(name, self._description)
        return self._groups[name]

    def _of(self, name: str) -> Any:
        if self._model is None or name not in self._model.groups:
            raise MoveItCommanderException(f"There is no group named {name}")
        return self._model.groups[name]

    def __getattr__(self, name: str) -> Any:
        """Return a group by attribute, as in `robot.arm`."""
        if name.startswith("_"):
            raise AttributeError(name)
        return self.get_group(name)
