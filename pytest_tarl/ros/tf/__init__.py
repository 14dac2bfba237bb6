"""rospy's older `tf`: listener and broadcaster with tuples instead of messages."""

# ruff: noqa: N802 (names are tf's)

from __future__ import annotations

from copy import deepcopy
from typing import Any

from pytest_tarl.ros import transformations
from pytest_tarl.ros.messages import message_type
from pytest_tarl.ros.tf2_geometry_msgs import (
    do_transform_point,
    do_transform_pose_stamped,
    do_transform_vector3,
)
from pytest_tarl.ros.tf2_ros.broadcasting import TransformBroadcaster as Tf2Broadcaster
from pytest_tarl.ros.tf2_ros.broadcasting import TransformListener as Tf2Listener
from pytest_tarl.ros.tf2_ros.buffer import Buffer
from pytest_tarl.ros.transforms import (
    ConnectivityException,
    ExtrapolationException,
    LookupException,
    TransformException,
    clean,
)

Exception = TransformException  # noqa: A001 (tf.Exception)

__all__ = [
    "ConnectivityException", "Exception", "ExtrapolationException", "LookupException", "TransformBroadcaster",
    "TransformListener", "Transformer", "TransformerROS", "transformations",
]  # fmt: skip

Parts = tuple[float, ...]


class TransformerROS:
    """Looks up transforms, as tuples (x, y, z) and (x, y, z, w)."""

    def __init__(self, interpolate: bool = True, cache_time: Any = None) -> None:  # noqa: ARG002
        self._buffer = Buffer(cache_time)

    def lookupTransform(
        self, target_frame: str, source_frame: str, time: Any
    ) -> tuple[list[float], list[float]]:
        """Return translation and rotation of the source frame in the target frame."""
        found = self._buffer.lookup_transform(clean(target_frame), clean(source_frame), time).transform
        move, turn = found.translation, found.rotation
        return [move.x, move.y, move.z], [turn.x, turn.y, turn.z, turn.w]

    def canTransform(self, target_frame: str, source_frame: str, time: Any) -> bool:
        """Return whether a look-up would succeed."""
        return bool(self._buffer.can_transform(clean(target_frame), clean(source_frame), time))

    def waitForTransform(
        self,
        target_frame: str,
        source_frame: str,
        time: Any,
        timeout: Any,
        polling_sleep_duration: Any = None,  # noqa: ARG002
    ) -> None:
        """Wait until a look-up would succeed. Raise tf.Exception after the timeout."""
        found, reason = self._buffer.can_transform(
            clean(target_frame), clean(source_frame), time, timeout, True
        )
        if not found:
            raise TransformException(f"timeout: {reason}")

    def lookupTransformFull(
        self, target_frame: str, target_time: Any, source_frame: str, source_time: Any, fixed_frame: str
    ) -> tuple[list[float], list[float]]:
        """Return translation and rotation of the source frame at one time in the target frame at another."""
        ends = clean(target_frame), target_time, clean(source_frame), source_time
        found = self._buffer.lookup_transform_full(*ends, clean(fixed_frame)).transform
        move, turn = found.translation, found.rotation
        return [move.x, move.y, move.z], [turn.x, turn.y, turn.z, turn.w]

    def canTransformFull(
        self, target_frame: str, target_time: Any, source_frame: str, source_time: Any, fixed_frame: str
    ) -> bool:
        """Return whether `lookupTransformFull` would succeed."""
        ends = clean(target_frame), target_time, clean(source_frame), source_time
        return bool(self._buffer.can_transform_full(*ends, clean(fixed_frame)))

    def waitForTransformFull(
        self,
        target_frame: str,
        target_time: Any,
        source_frame: str,
        source_time: Any,
        fixed_frame: str,
        timeout: Any,
        polling_sleep_duration: Any = None,  # noqa: ARG002
    ) -> None:
        """Wait until `lookupTransformFull` would succeed. Raise tf.Exception after the timeout."""
        ends = clean(target_frame), target_time, clean(source_frame), source_time
        found, reason = self._buffer.can_transform_full(*ends, clean(fixed_frame), timeout, True)
        if not found:
            raise TransformException(f"timeout: {reason}")

    def chain(
        self,
        target_frame: str,
        target_time: Any,  # noqa: ARG002
        source_frame: str,
        source_time: Any,  # noqa: ARG002
        fixed_frame: str,
    ) -> list[str]:
        """Return the frames from the source frame, via the fixed frame, to the target frame."""
        first = self._buffer.chain(clean(fixed_frame), clean(source_frame))
        return first + self._buffer.chain(clean(target_frame), clean(fixed_frame))[1:]

    def clear(self) -> None:
        """Discard all transforms except static ones."""
        self._buffer.clear()

    def getTFPrefix(self) -> str:
        """Return the prefix of frames, which is always empty in tf2."""
        return ""

    def setUsingDedicatedThread(self, value: bool) -> None:
        """Do nothing: transforms always arrive while a node waits."""

    def getLatestCommonTime(self, source_frame: str, dest_frame: str) -> Any:
        """Return the newest time at which both frames are known."""
        return self._buffer.get_latest_common_time(clean(source_frame), clean(dest_frame))

    def frameExists(self, frame_id: str) -> bool:
        """Return whether a frame is known."""
        return self._buffer.frame_exists(frame_id)

    def getFrameStrings(self) -> list[str]:
        """List all frames."""
        return self._buffer.frames()

    def allFramesAsString(self) -> str:
        """Describe the tree."""
        return self._buffer.all_frames_as_string()

    def setTransform(self, transform: Any, authority: str = "") -> None:
        """Add geometry_msgs/TransformStamped."""
        self._buffer.set_transform(transform, authority)

    def fromTranslationRotation(self, translation: Parts, rotation: Parts) -> Any:
        """Return the 4×4 matrix of a translation and a quaternion."""
        return transformations.compose(translation, rotation)

    def asMatrix(self, target_frame: str, hdr: Any) -> Any:
        """Return the 4×4 matrix that moves points from a header's frame to another."""
        move, turn = self.lookupTransform(target_frame, hdr.frame_id, hdr.stamp)
        return self.fromTranslationRotation(tuple(move), tuple(turn))

    def transformPoint(self, target_frame: str, ps: Any) -> Any:
        """Return a PointStamped in another frame."""
        return do_transform_point(ps, self._to(target_frame, ps))

    def transformVector3(self, target_frame: str, v3s: Any) -> Any:
        """Return a Vector3Stamped in another frame."""
        return do_transform_vector3(v3s, self._to(target_frame, v3s))

    def transformPose(self, target_frame: str, ps: Any) -> Any:
        """Return a PoseStamped in another frame."""
        return do_transform_pose_stamped(ps, self._to(target_frame, ps))

    def transformPointCloud(self, target_frame: str, point_cloud: Any) -> Any:
        """Return a PointCloud (the older cloud type) in another frame."""
        header = point_cloud.header
        turned = self.asMatrix(target_frame, header)
        moved: Any = type(point_cloud)()
        moved.header.stamp, moved.header.frame_id, moved.channels = (
            header.stamp,
            target_frame,
            point_cloud.channels,
        )
        point = message_type("geometry_msgs/Point32")
        moved.points = [
            point(*(float(part) for part in (turned @ (one.x, one.y, one.z, 1.0))[:3]))
            for one in point_cloud.points
        ]
        return moved

    def transformQuaternion(self, target_frame: str, ps: Any) -> Any:
        """Return a QuaternionStamped in another frame."""
        found = self._to(target_frame, ps)
        turn, own = found.transform.rotation, ps.quaternion
        moved = deepcopy(ps)
        moved.header.frame_id = target_frame
        product = transformations.quaternion_multiply(
            (turn.x, turn.y, turn.z, turn.w), (own.x, own.y, own.z, own.w)
        )
        moved.quaternion.x, moved.quaternion.y, moved.quaternion.z, moved.quaternion.w = (
            float(p) for p in product
        )
        return moved

    def _to(self, target_frame: str, message: Any) -> Any:
        header = message.header
        return self._buffer.lookup_transform(clean(target_frame), clean(header.frame_id), header.stamp)


Transformer = TransformerROS


class TransformListener(TransformerROS):
    """Subscribes to /tf and /tf_static."""

    def __init__(self, interpolate: bool = True, cache_time: Any = None) -> None:
        super().__init__(interpolate, cache_time)
        self._listener = Tf2Listener(self._buffer)


class TransformBroadcaster:
    """Publishes transforms."""

    def __init__(self, queue_size: int = 100) -> None:  # noqa: ARG002
        self._broadcaster = Tf2Broadcaster()

    def sendTransform(self, translation: Parts, rotation: Parts, time: Any, child: str, parent: str) -> None:
        """Publish one transform."""
        message: Any = message_type("geometry_msgs/TransformStamped")()
        message.header.frame_id, message.header.stamp, message.child_frame_id = parent, time, child
        move, turn = message.transform.translation, message.transform.rotation
        move.x, move.y, move.z = translation
        turn.x, turn.y, turn.z, turn.w = rotation
        self.sendTransformMessage(message)

    def sendTransformMessage(self, transform: Any) -> None:
        """Publish geometry_msgs/TransformStamped."""
        self._broadcaster.sendTransform(transform)
