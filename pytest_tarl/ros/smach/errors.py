"""smach's exceptions."""

from __future__ import annotations


class SmachError(Exception):
    """An error in a state machine."""


class InvalidStateError(SmachError):
    """A state is invalid, or a container is in an invalid state."""


class InvalidTransitionError(SmachError):
    """A transition leads nowhere, or an outcome is not declared."""


class InvalidConstructionError(SmachError):
    """A container is used incorrectly while states are added."""


class InvalidUserCodeError(SmachError):
    """A state uses userdata that it does not declare, or raised an error."""
