"""Check the values that a node's callbacks return."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from pytest_tarl.ros import blame


class ReturnedTypeError(TypeError):
    """A callback returned a value of the wrong type; `tarl_place` is where the callback is defined."""

    def __init__(self, message: str, callback: Callable[..., Any]) -> None:
        super().__init__(message)
        self.tarl_place = blame.of_function(callback)


def require_returned(value: Any, wanted: type, what: str, callback: Callable[..., Any]) -> None:
    """Raise ReturnedTypeError unless a callback returned a value of type `wanted`.

    `what` starts the sentence, as in "the callback of service /dock".
    """
    if not isinstance(value, wanted):
        raise ReturnedTypeError(f"{what} returned {type(value)}, not {wanted}", callback)
