"""smach: state machines of tasks. The states of a Concurrence run as tasks on the virtual clock."""

from __future__ import annotations

from pytest_tarl.ros.smach.callbacks import CBState, cb_interface, has_smach_interface
from pytest_tarl.ros.smach.concurrence import Concurrence
from pytest_tarl.ros.smach.container import Container
from pytest_tarl.ros.smach.errors import (
    InvalidConstructionError,
    InvalidStateError,
    InvalidTransitionError,
    InvalidUserCodeError,
    SmachError,
)
from pytest_tarl.ros.smach.iterating import Iterator
from pytest_tarl.ros.smach.log import (
    is_shutdown,
    logdebug,
    logerr,
    loginfo,
    logwarn,
    set_loggers,
    set_shutdown_check,
)
from pytest_tarl.ros.smach.machine import Sequence, StateMachine
from pytest_tarl.ros.smach.state import State
from pytest_tarl.ros.smach.userdata import Remapper, UserData

__all__ = [
    "CBState", "Concurrence", "Container", "InvalidConstructionError", "InvalidStateError", "InvalidTransitionError",
    "InvalidUserCodeError", "Iterator", "Remapper", "Sequence", "SmachError", "State", "StateMachine", "UserData",
    "cb_interface", "has_smach_interface", "is_shutdown", "logdebug", "logerr", "loginfo", "logwarn", "set_loggers",
    "set_shutdown_check",
]  # fmt: skip
