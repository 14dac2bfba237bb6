"""`topic_tools`: a base class for nodes that subscribe only while somebody listens to them; the world always does."""

from __future__ import annotations

from typing import Any

from pytest_tarl.ros.missing import refuse
from pytest_tarl.ros.rospy.parameters import get_param
from pytest_tarl.ros.rospy.topics import Publisher, SubscribeListener

__all__ = ["LazyTransport"]


class _Subscribing(type):
    """Calls `_post_init` once the node's own constructor is through."""

    def __call__(cls, *args: Any, **kwds: Any) -> Any:
        node = super().__call__(*args, **kwds)
        node._post_init()
        return node


class LazyTransport(SubscribeListener, metaclass=_Subscribing):
    """A node that publishes what it makes of other topics: `advertise`, `subscribe` and `unsubscribe`.

    Without the parameter `~lazy` it subscribes when a first peer does. The simulated world is a peer of every topic, so
    the node subscribes as soon as it advertises something.
    """

    def __init__(self) -> None:
        self._publishers: list[Publisher] = []
        self._connection_status: bool | None = None  # None until it first subscribes

    def subscribe(self) -> None:
        """Subscribe to what the node needs."""
        raise NotImplementedError("Please overwrite this method")

    def unsubscribe(self) -> None:
        """Give up what `subscribe` made."""
        raise NotImplementedError("Please overwrite this method")

    def advertise(self, *args: Any, **kwds: Any) -> Publisher:
        """Make a publisher whose peers decide whether the node subscribes."""
        publisher = Publisher(*args, **{**kwds, "subscriber_listener": self})
        self._publishers.append(publisher)
        return publisher

    def peer_subscribe(self, *_: Any, **__: Any) -> None:
        """Subscribe, unless the node does so already."""
        if not self._connection_status:
            self.subscribe()
            self._connection_status = True

    def peer_unsubscribe(self, *_: Any, **__: Any) -> None:
        """Unsubscribe once nobody listens to any publisher."""
        if not get_param("~lazy", True) or not self._connection_status:
            return
        if all(publisher.get_num_connections() == 0 for publisher in self._publishers):
            self.unsubscribe()
            self._connection_status = False

    def _post_init(self) -> None:
        if self._publishers or not get_param("~lazy", True):
            self.peer_subscribe()


def __getattr__(name: str) -> Any:
    """Name what is missing."""
    raise refuse("topic_tools", name)
