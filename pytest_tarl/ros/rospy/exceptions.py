"""The exceptions of rospy."""

from __future__ import annotations


class ROSException(Exception):  # noqa: N818 (these names are rospy's)
    """Base of what rospy raises."""


class ROSSerializationException(ROSException):
    """A message cannot be sent."""


class ROSInternalException(Exception):  # noqa: N818
    """Base of what rospy raises about itself."""


class ROSInitException(ROSException):
    """Something was used before `init_node`."""


class TransportException(ROSInternalException):
    """Base of transport errors."""


class TransportTerminated(TransportException):
    """A connection went away."""


class TransportInitError(TransportException):
    """A connection could not be made."""


class ROSInterruptException(ROSException, KeyboardInterrupt):
    """A blocking call was interrupted by the node's shutdown."""

    tarl_shutdown = True  # the ordinary end of a node, nothing to report


class ROSTimeMovedBackwardsException(ROSInterruptException):
    """The clock jumped back; it never does here."""

    def __init__(self, time: float = 0.0) -> None:
        super().__init__("ROS time moved backwards")
        self.time = time


class UnknownHostException(ROSInternalException):
    """A host name cannot be resolved."""


class ServiceException(Exception):  # noqa: N818
    """A service call failed."""
