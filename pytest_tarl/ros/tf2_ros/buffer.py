"""tf2_ros's Buffer: look-ups with a timeout, and transforming stamped messages."""

# ruff: noqa: ARG002 (signatures are tf2_ros's)

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module
from typing import Any

from pytest_tarl.ros.process import current_process
from pytest_tarl.ros.transforms import DEFAULT_CACHE, TransformException, TransformTree, clean

_LOOK = 10_000_000  # polling period of a waiting look-up (ns)


class TypeException(Exception):  # noqa: N818 (tf2_ros's name)
    """No transformation is registered for a type."""


class TransformRegistration:
    """Transformations by message class; importing tf2_geometry_msgs adds those for geometry."""

    def __init__(self) -> None:
        self._converters: dict[Any, Callable[[Any, Any], Any]] = {}

    def add(self, key: Any, callback: Callable[[Any, Any], Any]) -> None:
        """Register a type."""
        self._converters[key] = callback

    def get(self, key: Any) -> Callable[[Any, Any], Any]:
        """Return the function that transforms messages of a type. Raise TypeException if there is none."""
        if key in self._converters:
            return self._converters[key]
        if key.__name__ == "PointCloud2":
            transform: Callable[[Any, Any], Any] = import_module(
                "pytest_tarl.ros.tf2_sensor_msgs"
            ).do_transform_cloud
            return transform
        geometry = import_module("pytest_tarl.ros.tf2_geometry_msgs")
        found: Callable[[Any, Any], Any] | None = geometry.TRANSFORMERS.get(key.__name__)
        if found is None:
            raise TypeException(f"Type {key} if not loaded or supported")
        return found


class BufferInterface:
    """What both kinds of buffers build on look-ups."""

    def __init__(self) -> None:
        self.registration = TransformRegistration()

    def lookup_transform(self, target_frame: str, source_frame: str, time: Any, timeout: Any = None) -> Any:
        """Return the transform from the source frame to the target frame."""
        raise NotImplementedError

    def transform(
        self, object_stamped: Any, target_frame: str, timeout: Any = None, new_type: Any = None
    ) -> Any:
        """Transform a stamped message into another frame."""
        header = object_stamped.header
        found = self.lookup_transform(target_frame, header.frame_id, header.stamp, timeout)
        return self.registration.get(type(object_stamped))(object_stamped, found)

    def lookup_transform_full(
        self,
        target_frame: str,
        target_time: Any,
        source_frame: str,
        source_time: Any,
        fixed_frame: str,
        timeout: Any = None,
    ) -> Any:
        """Return the transform from `source_frame` at one time to `target_frame` at another, via a fixed frame."""
        raise NotImplementedError

    def transform_full(
        self,
        object_stamped: Any,
        target_frame: str,
        target_time: Any,
        fixed_frame: str,
        timeout: Any = None,
        new_type: Any = None,
    ) -> Any:
        """Transform a stamped message into another frame at another time, via a fixed frame."""
        header = object_stamped.header
        found = self.lookup_transform_full(
            target_frame, target_time, header.frame_id, header.stamp, fixed_frame, timeout
        )
        return self.registration.get(type(object_stamped))(object_stamped, found)


class Buffer(BufferInterface):
    """Stores received transforms and answers look-ups."""

    def __init__(self, cache_time: Any = None, debug: Any = True, node: Any = None) -> None:
        super().__init__()
        self.process = current_process("tf2_ros.Buffer")
        self._tree = TransformTree(nanoseconds_of(cache_time) if cache_time is not None else DEFAULT_CACHE)
        self._waiting: list[tuple[Any, tuple[str, str, Any]]] = []

    def set_transform(self, transform: Any, authority: str) -> None:
        """Add geometry_msgs/TransformStamped."""
        self._tree.add(transform, nanoseconds_of(transform.header.stamp), static=False, authority=authority)
        self._answer()

    def set_transform_static(self, transform: Any, authority: str) -> None:
        """Add a constant transform."""
        self._tree.add(transform, nanoseconds_of(transform.header.stamp), static=True, authority=authority)
        self._answer()

    def lookup_transform(self, target_frame: str, source_frame: str, time: Any, timeout: Any = None) -> Any:
        """Return the transform from `source_frame` to `target_frame`; wait up to `timeout`.

        Raise TransformException if there is none.
        """
        self.can_transform(target_frame, source_frame, time, timeout)
        return self._message(target_frame, source_frame, nanoseconds_of(time))

    def lookup_transform_full(
        self,
        target_frame: str,
        target_time: Any,
        source_frame: str,
        source_time: Any,
        fixed_frame: str,
        timeout: Any = None,
    ) -> Any:
        """Return the transform from `source_frame` at one time to `target_frame` at another, via a fixed frame."""
        self.can_transform_full(target_frame, target_time, source_frame, source_time, fixed_frame, timeout)
        inner, _ = self._tree.look_up(fixed_frame, source_frame, nanoseconds_of(source_time))
        outer, when = self._tree.look_up(target_frame, fixed_frame, nanoseconds_of(target_time))
        return _stamped(outer @ inner, target_frame, source_frame, when)

    def can_transform(
        self,
        target_frame: str,
        source_frame: str,
        time: Any,
        timeout: Any = None,
        return_debug_tuple: bool = False,
    ) -> Any:
        """Return whether a look-up would succeed; wait up to `timeout`."""
        reason = self._wait(lambda: self._problem(target_frame, source_frame, time), timeout)
        return (not reason, reason) if return_debug_tuple else not reason

    def can_transform_full(
        self,
        target_frame: str,
        target_time: Any,
        source_frame: str,
        source_time: Any,
        fixed_frame: str,
        timeout: Any = None,
        return_debug_tuple: bool = False,
    ) -> Any:
        """Return whether a look-up via a fixed frame would succeed; wait up to `timeout`."""

        def problem() -> str:
            inner = self._problem(fixed_frame, source_frame, source_time)
            return inner or self._problem(target_frame, fixed_frame, target_time)

        reason = self._wait(problem, timeout)
        return (not reason, reason) if return_debug_tuple else not reason

    def _wait(self, problem: Callable[[], str], timeout: Any) -> str:
        """Wait up to `timeout` until there is no problem; return the problem that remains."""
        clock = self.process.scheduler
        until = clock.time + (nanoseconds_of(timeout) if timeout is not None else 0)
        reason = problem()
        while reason and clock.time < until and not self.process.ending:
            clock.wait(min(until, clock.time + _LOOK))
            reason = problem()
        return reason

    async def lookup_transform_async(self, target_frame: str, source_frame: str, time: Any) -> Any:
        """Return the transform between two frames once it is known (ROS 2)."""
        await self.wait_for_transform_async(target_frame, source_frame, time)
        return self.lookup_transform(target_frame, source_frame, time)

    def wait_for_transform_async(self, target_frame: str, source_frame: str, time: Any) -> Any:
        """Return a future that is done once a look-up would succeed (ROS 2)."""
        from pytest_tarl.ros.rclpy.task import Future

        future = Future()
        self._waiting.append((future, (target_frame, source_frame, time)))
        self._answer()
        return future

    def all_frames_as_string(self) -> str:
        """Describe the tree."""
        return "\n".join(
            f"Frame {c} exists with parent {e.parent}." for c, e in sorted(self._tree.edges.items())
        )

    def all_frames_as_yaml(self) -> str:
        """Describe the tree as YAML."""
        return "\n".join(f"{c}:\n  parent: '{e.parent}'" for c, e in sorted(self._tree.edges.items()))

    def clear(self) -> None:
        """Discard all transforms except static ones."""
        for child in [child for child, edge in self._tree.edges.items() if not edge.static]:
            del self._tree.edges[child]

    def get_latest_common_time(self, target_frame: str, source_frame: str) -> Any:
        """Return the newest time at which both frames are known."""
        when = self._tree.look_up(target_frame, source_frame, 0)[1]
        return _stamp(when)

    def frame_exists(self, frame: str) -> bool:
        """Return whether a frame is known."""
        return clean(frame) in self._tree.edges or any(
            e.parent == clean(frame) for e in self._tree.edges.values()
        )

    def chain(self, target_frame: str, source_frame: str) -> list[str]:
        """Return the frames from the source frame to the target frame."""
        return self._tree.chain(target_frame, source_frame)

    def frames(self) -> list[str]:
        """List all frames."""
        return sorted({*self._tree.edges, *(edge.parent for edge in self._tree.edges.values())})

    def _problem(self, target: str, source: str, time: Any) -> str:
        try:
            self._tree.look_up(target, source, nanoseconds_of(time))
        except TransformException as error:
            return str(error)
        return ""

    def _message(self, target: str, source: str, time: int) -> Any:
        pose, when = self._tree.look_up(target, source, time)
        return _stamped(pose, target, source, when)

    def _answer(self) -> None:
        for entry in tuple(self._waiting):
            future, question = entry
            if not self._problem(*question):
                self._waiting.remove(entry)
                future.set_result(True)


def nanoseconds_of(time: Any) -> int:
    """Convert a time or duration of either ROS generation, or float seconds, to nanoseconds."""
    if hasattr(time, "to_nsec"):
        return int(time.to_nsec())
    if hasattr(time, "nanoseconds"):
        return int(time.nanoseconds)
    if hasattr(time, "nanosec"):
        return int(time.sec) * 1_000_000_000 + int(time.nanosec)
    return round(float(time) * 1_000_000_000)


def transform_stamped() -> Any:
    """Create an empty geometry_msgs/TransformStamped of the node's ROS generation."""
    return import_module("geometry_msgs.msg").TransformStamped()


def _stamp(when: int) -> Any:
    stamp = transform_stamped().header.stamp
    seconds, rest = divmod(when, 1_000_000_000)
    if hasattr(stamp, "nsecs"):
        from pytest_tarl.ros.rospy.timing import Time

        return Time(seconds, rest)
    stamp.sec, stamp.nanosec = seconds, rest
    return stamp


def _stamped(pose: Any, target: str, source: str, when: int) -> Any:
    made = transform_stamped()
    made.header.stamp, made.header.frame_id, made.child_frame_id = _stamp(when), clean(target), clean(source)
    move, turn = made.transform.translation, made.transform.rotation
    move.x, move.y, move.z = (float(part) for part in pose.translation)
    turn.x, turn.y, turn.z, turn.w = (float(part) for part in pose.rotation)
    return made


__all__ = ["Buffer", "BufferInterface", "TransformRegistration", "TypeException"]
