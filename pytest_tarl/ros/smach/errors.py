"""smach's exceptions."""

from __future__ import annotations


class SmachError(Exception):
    """An error in a state machine."""


class InvalidStateError(SmachError):
    """A state, or the state that a container is in, is not valid."""


class InvalidTransitionError(SmachError):
    """A transition leads nowhere, or an outcome is not declared."""


class InvalidConstructionError(SmachError):
    """A container is used wrongly while states are added."""


class InvalidUserCodeError(SmachError):
    """A state reads or writes userdata that it does not declare, or raised an error."""
