"""Stand-in for `PyKDL`: geometry, chains and their kinematic solvers, without dynamics."""

from __future__ import annotations

from pytest_tarl.ros.kdl.chains import Chain, Jacobian, JntArray, Joint, Segment, Tree
from pytest_tarl.ros.kdl.frames import Equal, Frame, SetToZero, addDelta, diff, dot
from pytest_tarl.ros.kdl.rotations import Rotation
from pytest_tarl.ros.kdl.solvers import (
    ChainFkSolverPos_recursive,
    ChainIkSolverPos_LMA,
    ChainIkSolverPos_NR,
    ChainIkSolverPos_NR_JL,
    ChainIkSolverVel_pinv,
    ChainJntToJacSolver,
)
from pytest_tarl.ros.kdl.vectors import Twist, Vector, Wrench

__all__ = ["Chain", "ChainFkSolverPos_recursive", "ChainIkSolverPos_LMA", "ChainIkSolverPos_NR",
           "ChainIkSolverPos_NR_JL", "ChainIkSolverVel_pinv", "ChainJntToJacSolver", "Equal", "Frame", "Jacobian",
           "JntArray", "Joint", "Rotation", "Segment", "SetToZero", "Tree", "Twist", "Vector", "Wrench", "addDelta",
           "diff", "dot"]  # fmt: skip
