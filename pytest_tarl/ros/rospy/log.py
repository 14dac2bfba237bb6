"""rospy's logging functions, on top of Python's logger `rosout`, so that pytest captures them."""

# ruff: noqa: ARG001 (signatures are rospy's)

from __future__ import annotations

import logging
import sys
from collections.abc import Callable
from typing import Any

from pytest_tarl.ros.clock import nanoseconds
from pytest_tarl.ros.process import Process, current_process

_LOGGER = logging.getLogger("rosout")
Log = Callable[..., None]


class LogMemory:
    """The state of the `_once` and `_throttle` functions of a process, by call site."""

    def __init__(self, process: Process) -> None:
        self._clock = process.scheduler
        self._seen: dict[Any, int] = {}

    def first(self, key: Any) -> bool:
        """Return whether this is the first call from this site."""
        new = key not in self._seen
        self._seen[key] = self._clock.time
        return new

    def due(self, key: Any, period: float) -> bool:
        """Return whether at least `period` seconds have passed since this last returned True."""
        last = self._seen.get(key)
        if last is not None and self._clock.time - last < nanoseconds(period):
            return False
        self._seen[key] = self._clock.time
        return True


def _plain(level: int) -> Log:
    def log(msg: Any, *args: Any, logger_name: str | None = None, **kwargs: Any) -> None:
        logger = _LOGGER if logger_name is None else _LOGGER.getChild(logger_name)
        logger.log(level, msg, *args, **kwargs)

    return log


def _once(level: int) -> Log:
    def log(msg: Any, *args: Any, **kwargs: Any) -> None:
        if current_process("rospy.log").part(LogMemory).first(("once", *_caller())):
            _LOGGER.log(level, msg, *args)

    return log


def _throttle(level: int, *, identical: bool) -> Log:
    def log(period: float, msg: Any, *args: Any, **kwargs: Any) -> None:
        key = ("throttle", *_caller(), str(msg) if identical else "")
        if current_process("rospy.log").part(LogMemory).due(key, period):
            _LOGGER.log(level, msg, *args)

    return log


def _caller() -> tuple[str, int]:
    frame = sys._getframe(2)
    return frame.f_code.co_filename, frame.f_lineno


logdebug, loginfo, logwarn, logerr, logfatal = map(
    _plain, (logging.DEBUG, logging.INFO, logging.WARNING, logging.ERROR, logging.CRITICAL)
)
logout = loginfo
logdebug_once, loginfo_once, logwarn_once, logerr_once, logfatal_once = map(
    _once, (logging.DEBUG, logging.INFO, logging.WARNING, logging.ERROR, logging.CRITICAL)
)
logdebug_throttle = _throttle(logging.DEBUG, identical=False)
loginfo_throttle = _throttle(logging.INFO, identical=False)
logwarn_throttle = _throttle(logging.WARNING, identical=False)
logerr_throttle = _throttle(logging.ERROR, identical=False)
logfatal_throttle = _throttle(logging.CRITICAL, identical=False)
logdebug_throttle_identical = _throttle(logging.DEBUG, identical=True)
loginfo_throttle_identical = _throttle(logging.INFO, identical=True)
logwarn_throttle_identical = _throttle(logging.WARNING, identical=True)
logerr_throttle_identical = _throttle(logging.ERROR, identical=True)
logfatal_throttle_identical = _throttle(logging.CRITICAL, identical=True)
