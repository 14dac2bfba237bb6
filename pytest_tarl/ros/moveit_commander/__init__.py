"""Stand-in for `moveit_commander`: motions in joint space without obstacles. Pick, place and meshes are missing."""

from __future__ import annotations

import os  # imported here because nodes call moveit_commander.os._exit
from collections.abc import Sequence

from pytest_tarl.ros.moveit_commander import conversions
from pytest_tarl.ros.moveit_commander.exception import MoveItCommanderException
from pytest_tarl.ros.moveit_commander.move_group import MoveGroupCommander
from pytest_tarl.ros.moveit_commander.robot import RobotCommander
from pytest_tarl.ros.moveit_commander.scene import PlanningSceneInterface

__all__ = ["MoveGroupCommander", "MoveItCommanderException", "PlanningSceneInterface", "RobotCommander", "conversions",
           "os", "roscpp_initialize", "roscpp_shutdown"]  # fmt: skip


def roscpp_initialize(args: Sequence[str]) -> None:
    """Accept the command line; rospy alone connects the node."""


def roscpp_shutdown() -> None:
    """Do nothing; rospy alone disconnects the node."""
