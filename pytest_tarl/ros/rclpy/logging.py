"""rclpy's loggers on top of Python's `logging`, so that pytest captures them."""

# ruff: noqa: ARG001 (signatures are rclpy's)

from __future__ import annotations

import logging as python_logging
import sys
from enum import IntEnum
from typing import Any

from pytest_tarl.ros.clock import nanoseconds
from pytest_tarl.ros.process import current_process
from pytest_tarl.ros.rospy.log import LogMemory


class LoggingSeverity(IntEnum):
    """Log levels, with the same values as in Python."""

    UNSET = 0
    DEBUG = 10
    INFO = 20
    WARN = 30
    ERROR = 40
    FATAL = 50


class RcutilsLogger:
    """Logs under a node's name."""

    def __init__(self, name: str = "") -> None:
        self.name = name
        self._logger = python_logging.getLogger(f"rclpy.{name}" if name else "rclpy")

    def get_child(self, name: str) -> RcutilsLogger:
        """Return a child logger."""
        return RcutilsLogger(f"{self.name}.{name}" if self.name else name)

    def set_level(self, level: int) -> None:
        """Do nothing: pytest decides what is shown (`--log-level`), and the level would outlive the episode."""

    def get_effective_level(self) -> LoggingSeverity:
        """Return the default level of ROS."""
        return LoggingSeverity.INFO

    def is_enabled_for(self, severity: int) -> bool:
        """Return whether messages of a level are shown by default."""
        return severity >= LoggingSeverity.INFO

    def log(self, message: Any, severity: int, *, depth: int = 1, **options: Any) -> bool:
        """Log a message; `once`, `throttle_duration_sec` and `skip_first` apply per call site."""
        if options and not _wanted(sys._getframe(depth), options):
            return False
        if self._logger.isEnabledFor(severity):
            self._logger.log(int(severity), "%s", message)
        return True

    def debug(self, message: Any, **options: Any) -> bool:
        """Log at level DEBUG."""
        return self.log(message, LoggingSeverity.DEBUG, depth=2, **options)

    def info(self, message: Any, **options: Any) -> bool:
        """Log at level INFO."""
        return self.log(message, LoggingSeverity.INFO, depth=2, **options)

    def warning(self, message: Any, **options: Any) -> bool:
        """Log at level WARN."""
        return self.log(message, LoggingSeverity.WARN, depth=2, **options)

    warn = warning

    def error(self, message: Any, **options: Any) -> bool:
        """Log at level ERROR."""
        return self.log(message, LoggingSeverity.ERROR, depth=2, **options)

    def fatal(self, message: Any, **options: Any) -> bool:
        """Log at level FATAL."""
        return self.log(message, LoggingSeverity.FATAL, depth=2, **options)


def _wanted(frame: Any, options: dict[str, Any]) -> bool:
    memory = current_process("rclpy.logging").part(LogMemory)
    place = (frame.f_code.co_filename, frame.f_lineno)
    if options.get("skip_first") and memory.first(("skip", *place)):
        return False
    if options.get("once") and not memory.first(("once", *place)):
        return False
    period = options.get("throttle_duration_sec")
    return period is None or nanoseconds(period) <= 0 or memory.due(("throttle", *place), period)


def get_logger(name: str) -> RcutilsLogger:
    """Return the logger with this name. Raise ValueError if the name is empty."""
    if not name:
        raise ValueError("Logger name must not be empty.")
    return RcutilsLogger(name)


def set_logger_level(name: str, level: int, detailed_error: bool = False) -> None:
    """Do nothing: pytest decides what is shown."""


def get_logging_severity_from_string(log_severity: str) -> LoggingSeverity:
    """Return the level with this name (in any case). Raise RuntimeError for an unknown name."""
    try:
        return LoggingSeverity[log_severity.upper()]
    except KeyError:
        raise RuntimeError(f"failed to get the severity of {log_severity!r}") from None


def get_logger_level(name: str) -> LoggingSeverity:
    """Return UNSET: loggers have no level of their own."""
    return LoggingSeverity.UNSET


def initialize() -> None:
    """Do nothing."""


def shutdown() -> None:
    """Do nothing."""


def clear_config() -> None:
    """Do nothing."""


def get_logger_effective_level(name: str) -> LoggingSeverity:
    """Return the default level of ROS."""
    return LoggingSeverity.INFO
