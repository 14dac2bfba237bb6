"""`topic_tools.LazyTransport`: a base class for nodes that subscribe only while they have subscribers."""

from __future__ import annotations

from typing import Any

from pytest_tarl.ros.rospy.parameters import get_param
from pytest_tarl.ros.rospy.topics import Publisher, SubscribeListener

__all__ = ["LazyTransport"]


class _Subscribing(type):
    """Metaclass that calls `_post_init` after the node's constructor."""

    def __call__(cls, *args: Any, **kwds: Any) -> Any:
        node = super().__call__(*args, **kwds)
        node._post_init()
        return node


class LazyTransport(SubscribeListener, metaclass=_Subscribing):
    """A node that processes topics on demand: `advertise`, `subscribe` and `unsubscribe`.

    By default, it subscribes when its first peer does. The simulated world is a peer of every topic, so the node
    subscribes as soon as it advertises one.
    """

    def __init__(self) -> None:
        self._publishers: list[Publisher] = []
        self._connection_status: bool | None = None  # None before the first subscription

    def subscribe(self) -> None:
        """Subscribe to the input topics."""
        raise NotImplementedError("Please overwrite this method")

    def unsubscribe(self) -> None:
        """Undo `subscribe`."""
        raise NotImplementedError("Please overwrite this method")

    def advertise(self, *args: Any, **kwds: Any) -> Publisher:
        """Create a publisher; whether it has peers decides whether the node subscribes."""
        publisher = Publisher(*args, **{**kwds, "subscriber_listener": self})
        self._publishers.append(publisher)
        return publisher

    def peer_subscribe(self, *_: Any, **__: Any) -> None:
        """Subscribe, unless the node already has."""
        if not self._connection_status:
            self.subscribe()
            self._connection_status = True

    def peer_unsubscribe(self, *_: Any, **__: Any) -> None:
        """Unsubscribe once no publisher has a peer."""
        if not get_param("~lazy", True) or not self._connection_status:
            return
        if all(publisher.get_num_connections() == 0 for publisher in self._publishers):
            self.unsubscribe()
            self._connection_status = False

    def _post_init(self) -> None:
        if self._publishers or not get_param("~lazy", True):
            self.peer_subscribe()
