"""Run linear algebra in one thread.

Sums then keep their order, so results do not depend on the number of processors. Small matrices also become faster:
with other processes running, BLAS threads mostly wait for each other.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache, wraps
from typing import TYPE_CHECKING, ParamSpec, TypeVar

if TYPE_CHECKING:
    from threadpoolctl import ThreadpoolController

Parameters = ParamSpec("Parameters")
Result = TypeVar("Result")


def one_thread(function: Callable[Parameters, Result]) -> Callable[Parameters, Result]:
    """Return a function that runs `function` with one BLAS thread; other code is not limited."""

    @wraps(function)
    def limited(*positional: Parameters.args, **named: Parameters.kwargs) -> Result:
        with _libraries().limit(limits=1, user_api="blas"):
            return function(*positional, **named)

    return limited


@cache
def _libraries() -> ThreadpoolController:
    """Return a controller of the BLAS libraries (such as numpy's) that are loaded at the first call."""
    from threadpoolctl import ThreadpoolController

    return ThreadpoolController()
