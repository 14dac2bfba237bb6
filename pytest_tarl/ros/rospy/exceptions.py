"""The exceptions of rospy."""

from __future__ import annotations


class ROSException(Exception):  # noqa: N818 (these names are rospy's)
    """Base of rospy's exceptions."""


class ROSSerializationException(ROSException):
    """A message cannot be serialised."""


class ROSInternalException(Exception):  # noqa: N818
    """Base of rospy's internal errors."""


class ROSInitException(ROSException):
    """A function was called before `init_node`."""


class TransportException(ROSInternalException):
    """Base of transport errors."""


class TransportTerminated(TransportException):
    """A connection was closed."""


class TransportInitError(TransportException):
    """A connection could not be made."""


class ROSInterruptException(ROSException, KeyboardInterrupt):
    """A blocking call was interrupted by the node's shutdown."""

    tarl_shutdown = True  # a normal end of a node, which is not reported


class ROSTimeMovedBackwardsException(ROSInterruptException):
    """The clock jumped back; never raised here."""

    def __init__(self, time: float = 0.0) -> None:
        super().__init__("ROS time moved backwards")
        self.time = time


class UnknownHostException(ROSInternalException):
    """A host name cannot be resolved."""


class ServiceException(Exception):  # noqa: N818
    """A service call failed."""
