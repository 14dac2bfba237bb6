"""tf2_ros's listener and broadcasters, on /tf and /tf_static."""

# ruff: noqa: ARG002 (signatures are tf2_ros's)

from __future__ import annotations

from typing import Any

from pytest_tarl.ros.messages import message_type
from pytest_tarl.ros.transforms import InvalidArgumentException


def _publisher(node: Any, topic: str, *, static: bool) -> Any:
    if node is None:
        from pytest_tarl.ros.rospy.topics import Publisher

        return Publisher(topic, message_type("tf2_msgs/TFMessage"), latch=static, queue_size=100)
    from pytest_tarl.ros.rclpy.qos import DurabilityPolicy, QoSProfile

    durability = DurabilityPolicy.TRANSIENT_LOCAL if static else DurabilityPolicy.VOLATILE
    return node.create_publisher(
        message_type("tf2_msgs/msg/TFMessage"), topic, QoSProfile(depth=100, durability=durability)
    )


class TransformBroadcaster:
    """Publishes transforms: `TransformBroadcaster()` in ROS 1, `TransformBroadcaster(node)` in ROS 2."""

    def __init__(self, node: Any = None, qos: Any = None) -> None:
        self._publisher = _publisher(node, "/tf", static=False)
        self._message = message_type("tf2_msgs/TFMessage" if node is None else "tf2_msgs/msg/TFMessage")

    def sendTransform(self, transform: Any) -> None:  # noqa: N802 (tf2_ros's name)
        """Publish one or more transforms."""
        several = list(transform) if isinstance(transform, list | tuple) else [transform]
        self._publisher.publish(self._message(transforms=several))


class StaticTransformBroadcaster:
    """Publishes constant transforms, which later subscribers also get."""

    def __init__(self, node: Any = None, qos: Any = None) -> None:
        self._publisher = _publisher(node, "/tf_static", static=True)
        self._message = message_type("tf2_msgs/TFMessage" if node is None else "tf2_msgs/msg/TFMessage")
        self._sent: dict[str, Any] = {}

    def sendTransform(self, transform: Any) -> None:  # noqa: N802 (tf2_ros's name)
        """Publish one or more transforms, together with all earlier ones."""
        for one in list(transform) if isinstance(transform, list | tuple) else [transform]:
            self._sent[one.child_frame_id] = one
        self._publisher.publish(self._message(transforms=list(self._sent.values())))


class TransformListener:
    """Fills a buffer from /tf and /tf_static: `TransformListener(buffer)` or `TransformListener(buffer, node)`."""

    def __init__(self, buffer: Any, node: Any = None, *, spin_thread: bool = False, **_: Any) -> None:
        self.buffer = buffer
        self.node = node if hasattr(node, "create_subscription") else None
        self._subscriptions = [self._listen("/tf", self._take), self._listen("/tf_static", self._take_static)]

    def unregister(self) -> None:
        """Unsubscribe."""
        for subscription in self._subscriptions:
            if self.node is None:
                subscription.unregister()
            else:
                self.node.destroy_subscription(subscription)

    unsubscribe = unregister

    def _listen(self, topic: str, callback: Any) -> Any:
        if self.node is None:
            from pytest_tarl.ros.rospy.topics import Subscriber

            return Subscriber(topic, message_type("tf2_msgs/TFMessage"), callback)
        from pytest_tarl.ros.rclpy.callback_groups import ReentrantCallbackGroup
        from pytest_tarl.ros.rclpy.qos import DurabilityPolicy, QoSProfile

        kept = DurabilityPolicy.TRANSIENT_LOCAL if topic == "/tf_static" else DurabilityPolicy.VOLATILE
        return self.node.create_subscription(message_type("tf2_msgs/msg/TFMessage"), topic, callback,
                                             QoSProfile(depth=100, durability=kept),
                                             callback_group=ReentrantCallbackGroup())  # fmt: skip

    def _take(self, message: Any) -> None:
        self._fill(message, self.buffer.set_transform)

    def _take_static(self, message: Any) -> None:
        self._fill(message, self.buffer.set_transform_static)

    def _fill(self, message: Any, store: Any) -> None:
        for transform in message.transforms:
            try:
                store(transform, "default_authority")
            except InvalidArgumentException as error:  # noqa: PERF203 (the others count all the same)
                import logging

                logging.getLogger("rosout").error("%s", error)
