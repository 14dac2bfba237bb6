"""diagnostic_updater for ROS 1 and ROS 2: tasks that fill statuses, and an updater that publishes them."""

from __future__ import annotations

from typing import Any

from pytest_tarl.ros.diagnostic_updater.checks import (
    DiagnosedPublisher,
    FrequencyStatus,
    FrequencyStatusParam,
    HeaderlessTopicDiagnostic,
    Heartbeat,
    TimeStampStatus,
    TimeStampStatusParam,
    TopicDiagnostic,
)
from pytest_tarl.ros.diagnostic_updater.status import wrapper_of
from pytest_tarl.ros.diagnostic_updater.tasks import (
    CompositeDiagnosticTask,
    DiagnosticTask,
    DiagnosticTaskVector,
    FunctionDiagnosticTask,
)
from pytest_tarl.ros.diagnostic_updater.updater import Updater

_MESSAGES = ["DiagnosticArray", "DiagnosticStatus", "KeyValue"]
_LEVELS = ["OK", "WARN", "ERROR"]
__all__ = [
    "CompositeDiagnosticTask", "DiagnosedPublisher", "DiagnosticStatusWrapper", "DiagnosticTask",
    "DiagnosticTaskVector", "FrequencyStatus", "FrequencyStatusParam", "FunctionDiagnosticTask",
    "HeaderlessTopicDiagnostic", "Heartbeat", "TimeStampStatus", "TimeStampStatusParam", "TopicDiagnostic", "Updater",
    *_MESSAGES, *_LEVELS,
]  # fmt: skip


def __getattr__(name: str) -> Any:
    """Return a class or level of the caller's ROS generation; raise for a name that the stand-in lacks."""
    if name != "DiagnosticStatusWrapper" and name not in (*_MESSAGES, *_LEVELS):
        raise AttributeError(name)
    from pytest_tarl.ros.install import kind_of_caller
    from pytest_tarl.ros.messages import class_of

    kind = kind_of_caller()
    if name in _MESSAGES:
        return class_of(kind, f"diagnostic_msgs/{name}")
    return wrapper_of(kind) if name not in _LEVELS else getattr(wrapper_of(kind), name)
