"""States and transitions of a lifecycle node (https://design.ros2.org/articles/node_lifecycle.html)."""

from __future__ import annotations

from enum import Enum
from typing import NamedTuple


class LifecycleState(NamedTuple):
    """A state, as passed to callbacks."""

    label: str
    state_id: int


class TransitionCallbackReturn(Enum):
    """The result of a transition callback."""

    SUCCESS = 97
    FAILURE = 98
    ERROR = 99


class Transition(NamedTuple):
    """A transition: its request, its start state, the intermediate state, and the next state for each result."""

    number: int
    label: str
    start: int
    through: int
    success: int
    failure: int


UNCONFIGURED, INACTIVE, ACTIVE, FINALIZED = 1, 2, 3, 4
CONFIGURING, CLEANING_UP, SHUTTING_DOWN, ACTIVATING, DEACTIVATING, ERROR_PROCESSING = range(10, 16)
LABELS = {
    0: "unknown", UNCONFIGURED: "unconfigured", INACTIVE: "inactive", ACTIVE: "active", FINALIZED: "finalized",
    CONFIGURING: "configuring", CLEANING_UP: "cleaningup", SHUTTING_DOWN: "shuttingdown",
    ACTIVATING: "activating", DEACTIVATING: "deactivating", ERROR_PROCESSING: "errorprocessing",
}  # fmt: skip
TRANSITIONS = (
    Transition(1, "configure", UNCONFIGURED, CONFIGURING, INACTIVE, UNCONFIGURED),
    Transition(2, "cleanup", INACTIVE, CLEANING_UP, UNCONFIGURED, INACTIVE),
    Transition(3, "activate", INACTIVE, ACTIVATING, ACTIVE, INACTIVE),
    Transition(4, "deactivate", ACTIVE, DEACTIVATING, INACTIVE, ACTIVE),
    Transition(5, "shutdown", UNCONFIGURED, SHUTTING_DOWN, FINALIZED, FINALIZED),
    Transition(6, "shutdown", INACTIVE, SHUTTING_DOWN, FINALIZED, FINALIZED),
    Transition(7, "shutdown", ACTIVE, SHUTTING_DOWN, FINALIZED, FINALIZED),
)
CALLBACKS = {
    CONFIGURING: "on_configure", CLEANING_UP: "on_cleanup", SHUTTING_DOWN: "on_shutdown",
    ACTIVATING: "on_activate", DEACTIVATING: "on_deactivate",
}  # fmt: skip


def state(number: int) -> LifecycleState:
    """Return a state by its number."""
    return LifecycleState(LABELS[number], number)
