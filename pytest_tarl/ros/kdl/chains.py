"""Joints, segments, chains and trees of PyKDL, without inertias."""

from __future__ import annotations

from enum import IntEnum
from typing import Any, Final

import numpy as np

from pytest_tarl.ros.kdl.frames import Frame
from pytest_tarl.ros.kdl.rotations import Rotation
from pytest_tarl.ros.kdl.vectors import WIDTH, Twist, Vector, equal
from pytest_tarl.ros.missing import unsupported

_AXES: Final = (Vector(1, 0, 0), Vector(0, 1, 0), Vector(0, 0, 1))


class JntArray:
    """A column of joint values."""

    def __init__(self, size: Any = 0) -> None:
        self.data = np.zeros(size) if isinstance(size, int) else size.data.copy()

    def rows(self) -> int:
        """Return the number of joints."""
        return len(self.data)

    def columns(self) -> int:
        """Return 1."""
        return 1

    def resize(self, size: int) -> None:
        """Set the number of joints; new values are zero."""
        self.data = np.concatenate([self.data, np.zeros(max(0, size - len(self.data)))])[:size]

    def __getitem__(self, place: int) -> float:
        _check(place, len(self.data), "JntArray")
        return float(self.data[place])

    def __setitem__(self, place: int, value: float) -> None:
        _check(place, len(self.data), "JntArray")
        self.data[place] = value

    def __eq__(self, other: object) -> bool:
        return (
            isinstance(other, JntArray) and len(self.data) == len(other.data) and equal(self.data, other.data)
        )

    __hash__ = None  # type: ignore[assignment]

    def __repr__(self) -> str:
        return f"[{' '.join(f'{value:{WIDTH}.6g}' for value in self.data)}]"


class Jacobian:
    """A matrix with six rows and one column (a twist) per joint."""

    def __init__(self, columns: Any = 0) -> None:
        self.data = np.zeros((6, columns)) if isinstance(columns, int) else columns.data.copy()

    def rows(self) -> int:
        """Return 6."""
        return 6

    def columns(self) -> int:
        """Return the number of joints."""
        return int(self.data.shape[1])

    def resize(self, columns: int) -> None:
        """Set the number of joints; all values become zero."""
        self.data = np.zeros((6, columns))

    def getColumn(self, place: int) -> Twist:  # noqa: N802 (these names are KDL's)
        """Return the twist caused by a joint at speed 1."""
        column = self.data[:, place]
        return Twist(Vector(*column[:3]), Vector(*column[3:]))

    def setColumn(self, place: int, twist: Twist) -> None:  # noqa: N802
        """Set the twist of a joint."""
        self.data[:, place] = list(twist)

    def changeRefPoint(self, moved: Vector) -> None:  # noqa: N802
        """Move the reference point of all columns."""
        for place in range(self.columns()):
            self.setColumn(place, self.getColumn(place).RefPoint(moved))

    def changeBase(self, rotation: Rotation) -> None:  # noqa: N802
        """Express all columns in another base."""
        for place in range(self.columns()):
            self.setColumn(place, rotation * self.getColumn(place))

    def changeRefFrame(self, frame: Frame) -> None:  # noqa: N802
        """Express all columns in another frame."""
        for place in range(self.columns()):
            self.setColumn(place, frame * self.getColumn(place))

    def __getitem__(self, place: tuple[int, int]) -> float:
        _check(place[0], 6, "Jacobian")
        _check(place[1], self.columns(), "Jacobian")
        return float(self.data[place])

    def __setitem__(self, place: tuple[int, int], value: float) -> None:
        _check(place[0], 6, "Jacobian")
        _check(place[1], self.columns(), "Jacobian")
        self.data[place] = value

    def __repr__(self) -> str:
        rows = [" ".join(f"{value:{WIDTH}.6g}" for value in row) + "\n" for row in self.data]
        return f"[{''.join(rows)}]"


class JointKind(IntEnum):
    """The kinds of joints."""

    RotAxis = 0
    RotX = 1
    RotY = 2
    RotZ = 3
    TransAxis = 4
    TransX = 5
    TransY = 6
    TransZ = 7
    Fixed = 8


class Joint:
    """A joint: optional name, optional origin and axis, then type, scale and offset."""

    JointType = JointKind
    RotAxis, RotX, RotY, RotZ = JointKind.RotAxis, JointKind.RotX, JointKind.RotY, JointKind.RotZ
    TransAxis, TransX, TransY, TransZ = (
        JointKind.TransAxis, JointKind.TransX, JointKind.TransY, JointKind.TransZ,
    )  # fmt: skip
    Fixed = JointKind.Fixed

    def __init__(self, *given: Any, **named: Any) -> None:
        values = list(given)
        if len(values) == 1 and isinstance(values[0], Joint):
            self.__dict__.update(values[0].__dict__)
            return
        self._name = str(
            values.pop(0) if values and isinstance(values[0], str) else named.get("name", "NoName")
        )
        vectors = [values.pop(0) for _ in range(2) if values and isinstance(values[0], Vector)]
        self._origin, self._axis = (*vectors, *(named.get(one, Vector()) for one in ("origin", "axis")))[:2]
        numbers = dict(
            zip(("type", "scale", "offset", "inertia", "damping", "stiffness"), values, strict=False)
        )
        numbers.update(named)
        self._kind = JointKind(numbers.get("type", JointKind.Fixed))
        self._scale, self._offset = float(numbers.get("scale", 1)), float(numbers.get("offset", 0))
        if self._kind not in (JointKind.RotAxis, JointKind.TransAxis):
            self._origin = Vector()
            self._axis = Vector() if self._kind is JointKind.Fixed else _AXES[(self._kind - 1) % 4]
        self._axis = Vector(self._axis)
        if self._kind is not JointKind.Fixed:
            self._axis.Normalize()

    def pose(self, value: float) -> Frame:
        """Return the joint's pose at a value."""
        angle = self._scale * value + self._offset
        if self._kind is JointKind.Fixed:
            return Frame()
        if self._kind < JointKind.TransAxis:
            return Frame(Rotation.Rot2(self._axis, angle), self._origin)
        return Frame(self._origin + self._axis * angle)

    def twist(self, speed: float) -> Twist:
        """Return the joint's twist at a speed."""
        moved = self._axis * (self._scale * speed)
        return Twist(Vector(), moved) if self._kind < JointKind.TransAxis else Twist(moved, Vector())

    def JointAxis(self) -> Vector:  # noqa: N802 (these names are KDL's)
        """Return the axis."""
        return Vector(self._axis)

    def JointOrigin(self) -> Vector:  # noqa: N802
        """Return the origin."""
        return Vector(self._origin)

    def getName(self) -> str:  # noqa: N802
        """Return the name."""
        return self._name

    def getType(self) -> JointKind:  # noqa: N802
        """Return the type."""
        return self._kind

    def getTypeName(self) -> str:  # noqa: N802
        """Return the name of the type."""
        return self._kind.name


class Segment:
    """A joint and the body that it moves, up to the frame `f_tip`."""

    def __init__(self, *given: Any, **named: Any) -> None:
        values = list(given)
        if len(values) == 1 and isinstance(values[0], Segment):
            self.__dict__.update(values[0].__dict__)
            return
        self._name = str(
            values.pop(0) if values and isinstance(values[0], str) else named.get("name", "NoName")
        )
        stated = {**dict(zip(("joint", "f_tip", "I"), values, strict=False)), **named}
        self._joint = Joint(stated.get("joint", Joint()))
        self._tip: Frame = self._joint.pose(0).Inverse() * stated.get("f_tip", Frame())

    def pose(self, value: float) -> Frame:
        """Return the pose of the tip at a joint value."""
        return self._joint.pose(value) * self._tip

    def twist(self, value: float, speed: float) -> Twist:
        """Return the twist of the tip at a joint value and speed."""
        return self._joint.twist(speed).RefPoint(self._joint.pose(value).M * self._tip.p)

    def getName(self) -> str:  # noqa: N802 (these names are KDL's)
        """Return the name."""
        return self._name

    def getJoint(self) -> Joint:  # noqa: N802
        """Return the joint."""
        return self._joint

    def getFrameToTip(self) -> Frame:  # noqa: N802
        """Return the pose of the tip at the joint value 0."""
        return self._joint.pose(0) * self._tip

    def getInertia(self) -> Any:  # noqa: N802
        """Raise UnsupportedApiError: inertias are not implemented."""
        raise unsupported("PyKDL.Segment.getInertia")


class Chain:
    """Segments in a row."""

    def __init__(self, other: Chain | None = None) -> None:
        self.segments: list[Segment] = list(other.segments) if other is not None else []

    def addSegment(self, segment: Segment) -> None:  # noqa: N802
        """Append a segment."""
        self.segments.append(segment)

    def addChain(self, chain: Chain) -> None:  # noqa: N802
        """Append the segments of a chain."""
        self.segments += chain.segments

    def getNrOfSegments(self) -> int:  # noqa: N802
        """Return the number of segments."""
        return len(self.segments)

    def getNrOfJoints(self) -> int:  # noqa: N802
        """Return the number of moving joints."""
        return sum(one.getJoint().getType() is not JointKind.Fixed for one in self.segments)

    def getSegment(self, place: int) -> Segment:  # noqa: N802
        """Return the segment with this index."""
        return self.segments[place]


class Tree:
    """Branching segments, each attached by name to another segment or to the root."""

    def __init__(self, root: str = "root") -> None:
        self._root = root
        self._above: dict[str, str] = {}
        self._segments: dict[str, Segment] = {}

    def addSegment(self, segment: Segment, hook: str) -> bool:  # noqa: N802
        """Attach a segment; return whether its parent exists."""
        name = segment.getName()
        if (
            (hook != self._root and hook not in self._segments)
            or name in self._segments
            or name == self._root
        ):
            return False
        self._segments[name], self._above[name] = segment, hook
        return True

    def addChain(self, chain: Chain, hook: str) -> bool:  # noqa: N802
        """Attach the segments of a chain one after the other; return whether all could be attached."""
        for segment in chain.segments:
            if not self.addSegment(segment, hook):
                return False
            hook = segment.getName()
        return True

    def getNrOfSegments(self) -> int:  # noqa: N802
        """Return the number of segments."""
        return len(self._segments)

    def getNrOfJoints(self) -> int:  # noqa: N802
        """Return the number of moving joints."""
        return sum(one.getJoint().getType() is not JointKind.Fixed for one in self._segments.values())

    def getChain(self, root: str, tip: str) -> Chain:  # noqa: N802
        """Return the segments from `root` to `tip`; `root` must be above `tip`.

        Raise UnsupportedApiError for chains that go up the tree.
        """
        names = []
        while tip != root:
            if tip not in self._segments:
                raise unsupported("PyKDL.Tree.getChain of a root that is not above the tip")
            names.append(tip)
            tip = self._above[tip]
        chain = Chain()
        for name in reversed(names):
            chain.addSegment(self._segments[name])
        return chain


def _check(place: int, size: int, what: str) -> None:
    if not 0 <= place < size:
        raise IndexError(f"{what} index out of range")
