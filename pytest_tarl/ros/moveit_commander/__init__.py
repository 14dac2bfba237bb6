"""Stand-in for `moveit_commander`: motions in joint space, without obstacles, pick, place and meshes."""

from __future__ import annotations

import os  # for nodes that call moveit_commander.os._exit
from collections.abc import Sequence

from pytest_tarl.ros.moveit_commander import conversions
from pytest_tarl.ros.moveit_commander.exception import MoveItCommanderException
from pytest_tarl.ros.moveit_commander.move_group import MoveGroupCommander
from pytest_tarl.ros.moveit_commander.robot import RobotCommander
from pytest_tarl.ros.moveit_commander.scene import PlanningSceneInterface

__all__ = ["MoveGroupCommander", "MoveItCommanderException", "PlanningSceneInterface", "RobotCommander", "conversions",
           "os", "roscpp_initialize", "roscpp_shutdown"]  # fmt: skip


def roscpp_initialize(args: Sequence[str]) -> None:
    """Accept the command line; the node connects through rospy alone."""


def roscpp_shutdown() -> None:
    """Do nothing; the node disconnects through rospy alone."""
