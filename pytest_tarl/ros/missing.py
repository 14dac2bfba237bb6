"""Errors for APIs that the in-process ROS does not implement."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Final

from pytest_tarl.errors import UnsupportedApiError, UnsupportedModuleError

_REPLACE: Final = "put a module of that name into sys.modules in your test"
_ADVICE: Final[Mapping[str, str]] = {  # package → alternative for the user
    "roslaunch": f"since tarl.launch starts launch files: call it in the test, or {_REPLACE}.",
    "image_transport": f"since its plugins are compiled libraries: {_REPLACE}, or use rospy and cv_bridge.",
}


def unsupported(api: str) -> UnsupportedApiError:
    """Return the error for an API that is not implemented, with advice."""
    return UnsupportedApiError(_sentence(api))


def unsupported_module(name: str) -> UnsupportedModuleError:
    """Return the error for a module that is not implemented, with advice; it is a ModuleNotFoundError, too."""
    return UnsupportedModuleError(_sentence(name), name=name)


def _sentence(api: str) -> str:
    advice = _ADVICE.get(api.partition(".")[0])
    if advice is not None:
        return f"{api} is not in the in-process ROS, {advice}"
    return (
        f"{api} is not in the in-process ROS yet: give the node a small stand-in for it in your test (monkeypatch "
        "the call, or put a module of that name into sys.modules), or drive the node only through the "
        "parts that exist."
    )


def refuse(module: str, name: str) -> Exception:
    """Return the error for a missing name of a stand-in module; AttributeError for dunder names, as Python expects."""
    if name.startswith("__"):
        return AttributeError(f"module {module!r} has no attribute {name!r}")
    return unsupported(f"{module}.{name}")


def refusing(module: str) -> Callable[[str], object]:
    """Return a module-level `__getattr__` that raises for every name."""

    def __getattr__(name: str) -> object:  # noqa: N807
        raise refuse(module, name)

    return __getattr__
