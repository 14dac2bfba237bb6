"""`rospy.core`: rospy's functions, and some for a node's state that `rospy` does not have."""

from __future__ import annotations

import functools
import warnings
from collections.abc import Callable
from importlib import import_module
from typing import Any

from pytest_tarl.ros.rospy.log import logdebug, logerr, loginfo, logwarn
from pytest_tarl.ros.rospy.node import is_shutdown, on_shutdown, this_node

rospydebug, rospyinfo, rospywarn, rospyerr = logdebug, loginfo, logwarn, logerr
logerror = logerr
is_shutdown_requested = is_shutdown


def is_initialized() -> bool:
    """Return whether `init_node` was called."""
    return this_node("core.is_initialized").initialised


def add_shutdown_hook(h: Callable[[str], Any]) -> None:
    """Call `h(reason)` at shutdown."""
    on_shutdown(functools.partial(h, "shutdown"))


add_client_shutdown_hook = add_preshutdown_hook = add_shutdown_hook


def deprecated(func: Callable[..., Any]) -> Callable[..., Any]:
    """Wrap a function so that every call emits a DeprecationWarning."""

    @functools.wraps(func)
    def warned(*args: Any, **kwds: Any) -> Any:
        warnings.warn(f"Call to deprecated function {func.__name__}.", DeprecationWarning, stacklevel=2)
        return func(*args, **kwds)

    return warned


def configure_logging(*_: Any, **__: Any) -> None:
    """Do nothing: pytest decides what is shown."""


def __getattr__(name: str) -> Any:
    """Return a function of rospy; raise for a name that the stand-in lacks."""
    rospy = vars(import_module("pytest_tarl.ros.rospy"))
    if name in rospy and not name.startswith("__"):
        return rospy[name]
    raise AttributeError(name)
