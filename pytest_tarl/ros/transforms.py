"""The tree of coordinate frames in a tf2 buffer: frame poses over time, and transforms between any two frames."""

from __future__ import annotations

import math
from bisect import bisect_left, insort
from dataclasses import dataclass, field
from typing import Any

Vector = tuple[float, float, float]
Quaternion = tuple[float, float, float, float]

DEFAULT_CACHE = 10_000_000_000  # maximum age of stored transforms (ns)


class TransformException(Exception):  # noqa: N818 (these names are tf2's)
    """A transform cannot be computed."""


class LookupException(TransformException):
    """A frame does not exist."""


class ConnectivityException(TransformException):
    """Two frames are not in the same tree."""


class ExtrapolationException(TransformException):
    """A time is outside the range of the received transforms."""


class InvalidArgumentException(TransformException):
    """A frame name or a quaternion is not valid."""


class TimeoutException(TransformException):
    """A look-up timed out."""


@dataclass(frozen=True, slots=True)
class Rigid:
    """A rotation followed by a translation."""

    translation: Vector = (0.0, 0.0, 0.0)
    rotation: Quaternion = (0.0, 0.0, 0.0, 1.0)  # x, y, z, w

    def __matmul__(self, inner: Rigid) -> Rigid:
        moved = rotate(self.rotation, inner.translation)
        translation = tuple(a + b for a, b in zip(self.translation, moved, strict=True))
        return Rigid(translation, multiply(self.rotation, inner.rotation))  # type: ignore[arg-type]

    def inverse(self) -> Rigid:
        """Return the inverse transform."""
        x, y, z, w = self.rotation
        back = (-x, -y, -z, w)
        a, b, c = rotate(back, self.translation)
        return Rigid((-a, -b, -c), back)

    def apply(self, point: Vector) -> Vector:
        """Return a point in the outer frame."""
        x, y, z = rotate(self.rotation, point)
        return x + self.translation[0], y + self.translation[1], z + self.translation[2]


def multiply(outer: Quaternion, inner: Quaternion) -> Quaternion:
    """Return the quaternion product: rotate by `inner`, then by `outer`."""
    x1, y1, z1, w1 = outer
    x0, y0, z0, w0 = inner
    return (
        w1 * x0 + x1 * w0 + y1 * z0 - z1 * y0,
        w1 * y0 - x1 * z0 + y1 * w0 + z1 * x0,
        w1 * z0 + x1 * y0 - y1 * x0 + z1 * w0,
        w1 * w0 - x1 * x0 - y1 * y0 - z1 * z0,
    )


def rotate(turn: Quaternion, vector: Vector) -> Vector:
    """Rotate a vector by a unit quaternion."""
    x, y, z, w = turn
    a, b, c = vector
    tx, ty, tz = 2 * (y * c - z * b), 2 * (z * a - x * c), 2 * (x * b - y * a)
    return a + w * tx + y * tz - z * ty, b + w * ty + z * tx - x * tz, c + w * tz + x * ty - y * tx


def slerp(start: Quaternion, end: Quaternion, share: float) -> Quaternion:
    """Interpolate between two unit quaternions (slerp), at `share` from 0 to 1 along the shorter arc."""
    cosine = sum(a * b for a, b in zip(start, end, strict=True))
    if cosine < 0:
        cosine, end = -cosine, (-end[0], -end[1], -end[2], -end[3])
    if cosine > 1 - 1e-12:
        return end if share > 0.5 else start
    angle = math.acos(cosine)
    before, after = math.sin((1 - share) * angle) / math.sin(angle), math.sin(share * angle) / math.sin(angle)
    x, y, z, w = (before * a + after * b for a, b in zip(start, end, strict=True))
    return x, y, z, w


@dataclass
class Edge:
    """A frame's pose in its parent over time (ns); constant if static."""

    parent: str
    static: bool
    times: list[int] = field(default_factory=list)
    poses: dict[int, Rigid] = field(default_factory=dict)

    def at(self, time: int, child: str) -> Rigid:
        """Return the interpolated pose at a time (0: the latest).

        Raise ExtrapolationException if the time is outside the received data.
        """
        if self.static or time == 0:
            return self.poses[self.times[-1]]
        if time in self.poses:
            return self.poses[time]
        place = bisect_left(self.times, time)
        if place in (0, len(self.times)):
            which, limit = ("past", self.times[0]) if place == 0 else ("future", self.times[-1])
            bound = "earliest" if place == 0 else "latest"
            raise ExtrapolationException(
                f"Lookup would require extrapolation into the {which}.  Requested time {time / 1e9:f} but the {bound} "
                f"data is at time {limit / 1e9:f}, when looking up transform from frame [{child}] to frame "
                f"[{self.parent}]"
            )
        before, after = self.times[place - 1], self.times[place]
        share = (time - before) / (after - before)
        first, second = self.poses[before], self.poses[after]
        x, y, z = (a + share * (b - a) for a, b in zip(first.translation, second.translation, strict=True))
        return Rigid((x, y, z), slerp(first.rotation, second.rotation, share))


class TransformTree:
    """All known frames."""

    def __init__(self, cache: int = DEFAULT_CACHE) -> None:
        self.cache = cache
        self.edges: dict[str, Edge] = {}
        self.authorities: dict[str, str] = {}

    def add(self, message: Any, time: int, *, static: bool, authority: str = "") -> None:
        """Add geometry_msgs/TransformStamped.

        Raise InvalidArgumentException if the message is not a valid transform.
        """
        child, parent = clean(message.child_frame_id), clean(message.header.frame_id)
        move, turn = message.transform.translation, message.transform.rotation
        pose = Rigid((move.x, move.y, move.z), (turn.x, turn.y, turn.z, turn.w))
        if not child or not parent or child == parent or abs(math.hypot(*pose.rotation) - 1) > 1e-2:
            raise InvalidArgumentException(
                f"Ignoring transform from child frame_id {child!r} to {parent!r}: frames must differ and have names, "
                f"and the rotation must be a unit quaternion, not {pose.rotation}"
            )
        edge = self.edges.get(child)
        if edge is None or edge.parent != parent or edge.static != static:
            edge = self.edges[child] = Edge(parent, static)
        self.authorities[child] = authority
        if static:
            edge.times.clear()
        if time not in edge.poses:
            insort(edge.times, time)
        edge.poses[time] = pose
        while edge.times[0] < edge.times[-1] - self.cache:
            del edge.poses[edge.times.pop(0)]

    def look_up(self, target: str, source: str, time: int) -> tuple[Rigid, int]:
        """Return the pose of `source` in `target`, and its time (`time` 0 requests the latest common one).

        Raise LookupException for an unknown frame, ConnectivityException if the frames are in different trees, and
        ExtrapolationException if the time is outside the received data.
        """
        target, source = self._known(target), self._known(source)
        up, down = self._way_up(source), self._way_up(target)
        common = next((frame for frame in up if frame in down), None)
        if common is None:
            raise ConnectivityException(
                f"Could not find a connection between '{target}' and '{source}' because they are not part of the same "
                "tree. Tf has two or more unconnected trees."
            )
        ways = [way[: way.index(common)] for way in (up, down)]
        if time == 0:
            moving = [self.edges[child] for way in ways for child in way if not self.edges[child].static]
            time = min((edge.times[-1] for edge in moving), default=0)
        to_source, to_target = (self._along(way, time) for way in ways)
        return to_target.inverse() @ to_source, time

    def chain(self, target: str, source: str) -> list[str]:
        """Return the frames from `source` to `target`. Raise the exceptions of `look_up`."""
        self.look_up(target, source, 0)
        up, down = self._way_up(clean(source)), self._way_up(clean(target))
        common = next(frame for frame in up if frame in down)
        return up[: up.index(common) + 1] + down[: down.index(common)][::-1]

    def _along(self, way: list[str], time: int) -> Rigid:
        pose = Rigid()
        for child in way:
            pose = self.edges[child].at(time, child) @ pose
        return pose

    def _way_up(self, frame: str) -> list[str]:
        way = [frame]
        while way[-1] in self.edges and len(way) <= len(self.edges):
            way.append(self.edges[way[-1]].parent)
        return way

    def _known(self, frame: str) -> str:
        name = clean(frame)
        if not name or frame.startswith("/"):
            raise InvalidArgumentException(f'Invalid argument "{frame}" passed to lookupTransform: in tf2 frame_ids '
                                           'cannot be empty or start with a "/"')  # fmt: skip
        if name not in self.edges and all(edge.parent != name for edge in self.edges.values()):
            raise LookupException(f'"{name}" passed to lookupTransform argument does not exist. ')
        return name


def clean(frame: str) -> str:
    """Return a frame's name without the leading slash of tf1."""
    return frame.lstrip("/")
