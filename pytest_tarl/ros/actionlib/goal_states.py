"""Goal states as seen by an ActionClient, and the transitions caused by a status from the server."""

from __future__ import annotations

from typing import Final

from pytest_tarl.ros.actionlib import protocol


class CommState:
    """The state of the communication about a goal."""

    WAITING_FOR_GOAL_ACK, PENDING, ACTIVE, WAITING_FOR_RESULT, WAITING_FOR_CANCEL_ACK = range(5)
    RECALLING, PREEMPTING, DONE, LOST = range(5, 9)

    @classmethod
    def to_string(cls, state: int) -> str:
        """Return the name of a state."""
        return _name(cls, state)


class TerminalState:
    """The states in which a goal can end."""

    RECALLED, REJECTED, PREEMPTED = protocol.RECALLED, protocol.REJECTED, protocol.PREEMPTED
    ABORTED, SUCCEEDED, LOST = protocol.ABORTED, protocol.SUCCEEDED, protocol.LOST

    @classmethod
    def to_string(cls, state: int) -> str:
        """Return the name of a state."""
        return _name(cls, state)


def _name(kind: type, state: int) -> str:
    names = {value: name for name, value in vars(kind).items() if isinstance(value, int)}
    return names.get(state, "No such constant")


_PENDING, _ACTIVE, _RESULT = CommState.PENDING, CommState.ACTIVE, CommState.WAITING_FOR_RESULT
_ACKNOWLEDGED: Final = {  # status → states of a goal without a cancel request
    protocol.PENDING: (_PENDING,),
    protocol.ACTIVE: (_ACTIVE,),
    protocol.REJECTED: (_PENDING, _RESULT),
    protocol.RECALLING: (_PENDING, CommState.RECALLING),
    protocol.RECALLED: (_PENDING, CommState.RECALLING, _RESULT),
    protocol.PREEMPTING: (_ACTIVE, CommState.PREEMPTING),
    protocol.PREEMPTED: (_ACTIVE, CommState.PREEMPTING, _RESULT),
    protocol.SUCCEEDED: (_ACTIVE, _RESULT),
    protocol.ABORTED: (_ACTIVE, _RESULT),
}
_CANCELLED: Final = {  # status → states of a goal with a cancel request
    protocol.REJECTED: (_RESULT,),
    protocol.RECALLING: (CommState.RECALLING,),
    protocol.RECALLED: (CommState.RECALLING, _RESULT),
    protocol.PREEMPTING: (CommState.PREEMPTING,),
    protocol.PREEMPTED: (CommState.PREEMPTING, _RESULT),
    protocol.SUCCEEDED: (CommState.PREEMPTING, _RESULT),
    protocol.ABORTED: (CommState.PREEMPTING, _RESULT),
}
_OVER: Final = (_RESULT, CommState.DONE)
_BEGUN: Final = (_ACTIVE, CommState.PREEMPTING)
_NEVER_BEGUN: Final = (protocol.PENDING, protocol.REJECTED, protocol.RECALLING, protocol.RECALLED)
_CANCELLING: Final = (CommState.WAITING_FOR_CANCEL_ACK, CommState.RECALLING, CommState.PREEMPTING)


def steps(state: int, status: int) -> tuple[int, ...]:
    """Return the states that follow `state` when the server reports `status`."""
    if state in _OVER or (state in _BEGUN and status in _NEVER_BEGUN):
        return ()
    path: tuple[int, ...] = (_CANCELLED if state in _CANCELLING else _ACKNOWLEDGED).get(status, ())
    if state == CommState.WAITING_FOR_GOAL_ACK and status == protocol.RECALLED:
        return (_PENDING, _RESULT)
    return path[path.index(state) + 1 :] if state in path else path
