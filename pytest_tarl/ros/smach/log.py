"""smach's log functions, which write to rospy's log if the node uses rospy."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from pytest_tarl.ros.process import running_process


def set_loggers(info: Any, warn: Any, debug: Any, error: Any) -> None:
    """Ignore the given log functions; messages go to the node's log."""


def set_shutdown_check(cb: Callable[[], bool]) -> None:
    """Ignore the given check; state machines end with the node."""


def is_shutdown() -> bool:
    """Return whether the node is ending."""
    process = running_process()
    return process is not None and process.ending


def loginfo(msg: str) -> None:
    """Log progress."""
    _log("loginfo", msg)


def logwarn(msg: str) -> None:
    """Log a warning."""
    _log("logwarn", msg)


def logerr(msg: str) -> None:
    """Log an error."""
    _log("logerr", msg)


def logdebug(msg: str) -> None:
    """Log a detail."""
    _log("logdebug", msg)


def _log(function: str, text: str) -> None:
    from pytest_tarl.ros.rospy import core, log

    if core.is_initialized():
        getattr(log, function)(text)
    elif function != "logdebug":
        print(text)
