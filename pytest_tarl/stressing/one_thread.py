"""Run linear algebra in one thread.

Sums then keep their order, so a result does not depend on the number of processors. Small matrices are also
faster: beside other processes, threads of BLAS spend most of their time waiting for each other.
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
    """Return the function such that its linear algebra takes one thread; code outside keeps its own number."""

    @wraps(function)
    def limited(*positional: Parameters.args, **named: Parameters.kwargs) -> Result:
        with _libraries().limit(limits=1, user_api="blas"):
            return function(*positional, **named)

    return limited


@cache
def _libraries() -> ThreadpoolController:
    """Return the libraries of linear algebra that are loaded at the first call, numpy's among them."""
    from threadpoolctl import ThreadpoolController

    return ThreadpoolController()
