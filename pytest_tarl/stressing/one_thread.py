"""Run linear algebra in one thread.

Sums then keep their order, so a result does not depend on the number of processors. Small matrices also become faster:
when other processes run, the threads of BLAS mostly wait for each other.
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
    """Return a function that runs `function` with one BLAS thread; other code keeps its number of threads."""

    @wraps(function)
    def limited(*positional: Parameters.args, **named: Parameters.kwargs) -> Result:
        with _libraries().limit(limits=1, user_api="blas"):
            return function(*positional, **named)

    return limited


@cache
def _libraries() -> ThreadpoolController:
    """Return a controller of the BLAS libraries that are loaded at the first call, such as numpy's."""
    from threadpoolctl import ThreadpoolController

    return ThreadpoolController()
