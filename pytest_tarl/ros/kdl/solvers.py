"""Kinematic solvers for PyKDL's chains."""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from pytest_tarl.ros.kdl.chains import Chain, Jacobian, JntArray, JointKind
from pytest_tarl.ros.kdl.frames import Equal, Frame, diff
from pytest_tarl.ros.kdl.rotations import Rotation
from pytest_tarl.ros.kdl.vectors import Twist, Vector

NO_ERROR: Final = 0
NO_CONVERGE: Final = -1
SIZE_MISMATCH: Final = -4
MAX_ITERATIONS: Final = -5
OUT_OF_RANGE: Final = -6
_TEXTS: Final = {
    0: "No error",
    -1: "Failed to converge",
    -4: "The size of the input does not match the internal state",
    -5: "The maximum number of iterations is exceeded",
    -6: "The requested index is out of range",
}


class _Solver:
    """A solver for one chain, and the error code of its last call."""

    def __init__(self, chain: Chain) -> None:
        self.chain = chain
        self._error = NO_ERROR

    def getError(self) -> int:  # noqa: N802 (these names are KDL's)
        """Return the error code of the last call."""
        return self._error

    def strError(self, code: int) -> str:  # noqa: N802
        """Return the text of an error code."""
        return _TEXTS.get(code, "UNKNOWN ERROR")

    def updateInternalDataStructures(self) -> None:  # noqa: N802
        """Do nothing: every call of a solver reads the chain again."""

    def _ended(self, code: int) -> int:
        self._error = code
        return code


class ChainFkSolverPos_recursive(_Solver):  # noqa: N801
    """Forward kinematics of positions."""

    def JntToCart(self, joints: JntArray, pose: Frame, segment: int = -1) -> int:  # noqa: N802
        """Write the pose of a segment's tip, by default the last one, into `pose`; return an error code."""
        count = self.chain.getNrOfSegments() if segment < 0 else segment
        pose.M, pose.p = Rotation(), Vector()
        if joints.rows() != self.chain.getNrOfJoints():
            return self._ended(SIZE_MISMATCH)
        if count > self.chain.getNrOfSegments():
            return self._ended(OUT_OF_RANGE)
        found = _poses(self.chain, joints)[count]
        pose.M, pose.p = found.M, found.p
        return self._ended(NO_ERROR)


class ChainJntToJacSolver(_Solver):
    """The Jacobian between the base and the tip of a chain."""

    def JntToJac(self, joints: JntArray, jacobian: Jacobian, segment: int = -1) -> int:  # noqa: N802
        """Write the Jacobian for a segment's tip, by default the last one; return an error code."""
        count = self.chain.getNrOfSegments() if segment < 0 else segment
        size = self.chain.getNrOfJoints()
        if joints.rows() != size or jacobian.columns() != size:
            return self._ended(SIZE_MISMATCH)
        if count > self.chain.getNrOfSegments():
            return self._ended(OUT_OF_RANGE)
        jacobian.data[:] = _jacobian(self.chain, joints, count)
        return self._ended(NO_ERROR)


class ChainIkSolverVel_pinv(_Solver):  # noqa: N801
    """Joint speeds for a twist of the tip, by the pseudo-inverse of the Jacobian."""

    def __init__(self, chain: Chain, eps: float = 0.00001, maxiter: int = 150) -> None:  # noqa: ARG002
        super().__init__(chain)
        self._eps = eps

    def CartToJnt(self, joints: JntArray, twist: Twist, speeds: JntArray) -> int:  # noqa: N802
        """Write the joint speeds into `speeds`; return an error code."""
        if joints.rows() != self.chain.getNrOfJoints() or speeds.rows() != joints.rows():
            return self._ended(SIZE_MISMATCH)
        matrix = _jacobian(self.chain, joints, self.chain.getNrOfSegments())
        speeds.data[:] = _pseudo_inverse(matrix, self._eps) @ np.array(list(twist))
        return self._ended(NO_ERROR)


class ChainIkSolverPos_NR(_Solver):  # noqa: N801
    """Joint values for a pose of the tip, by Newton-Raphson steps with a velocity solver."""

    def __init__(
        self,
        chain: Chain,
        fksolver: ChainFkSolverPos_recursive,
        iksolver: ChainIkSolverVel_pinv,
        maxiter: int = 100,
        eps: float = 1e-6,
    ) -> None:
        super().__init__(chain)
        self._forward, self._speeds, self._most, self._eps = fksolver, iksolver, maxiter, eps

    def CartToJnt(self, start: JntArray, pose: Frame, joints: JntArray) -> int:  # noqa: N802
        """Write the joint values into `joints`, starting from `start`; return an error code."""
        if start.rows() != self.chain.getNrOfJoints() or joints.rows() != start.rows():
            return self._ended(SIZE_MISMATCH)
        joints.data[:] = start.data
        here, change = Frame(), JntArray(joints.rows())
        for _ in range(self._most):
            self._forward.JntToCart(joints, here)
            twist = diff(here, pose)
            if Equal(twist, Twist(), self._eps):
                return self._ended(NO_ERROR)
            self._speeds.CartToJnt(joints, twist, change)
            joints.data[:] = self._bounded(joints.data + change.data)
        return self._ended(MAX_ITERATIONS)

    def _bounded(self, values: NDArray[np.float64]) -> NDArray[np.float64]:
        return values


class ChainIkSolverPos_NR_JL(ChainIkSolverPos_NR):  # noqa: N801
    """Joint values for a pose of the tip, within joint limits."""

    def __init__(
        self,
        chain: Chain,
        q_min: JntArray,
        q_max: JntArray,
        fksolver: ChainFkSolverPos_recursive,
        iksolver: ChainIkSolverVel_pinv,
        maxiter: int = 100,
        eps: float = 1e-6,
    ) -> None:
        super().__init__(chain, fksolver, iksolver, maxiter, eps)
        self._low, self._high = q_min, q_max

    def _bounded(self, values: NDArray[np.float64]) -> NDArray[np.float64]:
        return np.clip(values, self._low.data, self._high.data)


class ChainIkSolverPos_LMA(_Solver):  # noqa: N801
    """Joint values for a pose of the tip, by the Levenberg-Marquardt method; rotations have the weight 0.01."""

    def __init__(
        self, chain: Chain, eps: float = 1e-5, maxiter: int = 500, eps_joints: float = 1e-15
    ) -> None:
        super().__init__(chain)
        self._eps, self._most, self._least = eps, maxiter, eps_joints
        self._weights = np.array([1.0, 1.0, 1.0, 0.01, 0.01, 0.01])

    def CartToJnt(self, start: JntArray, pose: Frame, joints: JntArray) -> int:  # noqa: N802
        """Write the joint values into `joints`, starting from `start`; return an error code."""
        size = self.chain.getNrOfJoints()
        if start.rows() != size or joints.rows() != size:
            return self._ended(SIZE_MISMATCH)
        values, damping = JntArray(start), 10.0
        error = self._error_at(values, pose)
        for _ in range(self._most):
            if np.linalg.norm(error) < self._eps:
                break
            matrix = self._weights[:, None] * _jacobian(self.chain, values, self.chain.getNrOfSegments())
            step = np.linalg.solve(matrix.T @ matrix + damping * np.eye(size), matrix.T @ error)
            if np.abs(step).max() < self._least:
                break
            tried = JntArray(values)
            tried.data += step
            then = self._error_at(tried, pose)
            better = np.linalg.norm(then) < np.linalg.norm(error)
            damping = max(damping / 3, 1e-12) if better else damping * 4
            if better:
                values, error = tried, then
        joints.data[:] = values.data
        return self._ended(NO_ERROR if np.linalg.norm(error) < self._eps else NO_CONVERGE)

    def _error_at(self, values: JntArray, pose: Frame) -> NDArray[np.float64]:
        error: NDArray[np.float64] = np.array(list(diff(_poses(self.chain, values)[-1], pose)))
        return self._weights * error


def _poses(chain: Chain, joints: JntArray) -> list[Frame]:
    """Return the poses of the base and of all segment tips."""
    values = iter(joints.data)
    poses = [Frame()]
    for one in chain.segments:
        fixed = one.getJoint().getType() is JointKind.Fixed
        poses.append(poses[-1] * one.pose(0.0 if fixed else float(next(values))))
    return poses


def _jacobian(chain: Chain, joints: JntArray, count: int) -> NDArray[np.float64]:
    """Return the Jacobian for the tip of the first `count` segments, shape (6, joints)."""
    poses, columns = _poses(chain, joints), np.zeros((6, chain.getNrOfJoints()))
    values, column = iter(joints.data), 0
    for place, one in enumerate(chain.segments[:count]):
        if one.getJoint().getType() is JointKind.Fixed:
            continue
        twist = poses[place].M * one.twist(float(next(values)), 1.0)
        columns[:, column] = list(twist.RefPoint(poses[count].p - poses[place + 1].p))
        column += 1
    return columns


def _pseudo_inverse(matrix: NDArray[np.float64], eps: float) -> NDArray[np.float64]:
    """Return the pseudo-inverse; singular values up to `eps` count as zero."""
    left, values, right = np.linalg.svd(matrix, full_matrices=False)
    inverse = np.array([1 / one if one > eps else 0.0 for one in values])
    return np.asarray(right.T @ (inverse[:, None] * left.T), np.float64)
