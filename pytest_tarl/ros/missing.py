"""Errors that name an API which the in-process ROS does not have."""

from __future__ import annotations

from collections.abc import Callable

from pytest_tarl.errors import UnsupportedApiError


def unsupported(api: str) -> UnsupportedApiError:
    """Say that something of ROS is not there, and what to do."""
    return UnsupportedApiError(
        f"{api} is not in the in-process ROS yet: give the node a small stand-in for it in your test (monkeypatch "
        "the call, or put a module of that name into sys.modules), or drive the node through the parts that are there."
    )


def refuse(module: str, name: str) -> Exception:
    """Return the error for a name that a stand-in module lacks; Python's own probing gets its AttributeError."""
    if name.startswith("__"):
        return AttributeError(f"module {module!r} has no attribute {name!r}")
    return unsupported(f"{module}.{name}")


def refusing(module: str) -> Callable[[str], object]:
    """Return a module-level `__getattr__` that refuses everything."""

    def __getattr__(name: str) -> object:  # noqa: N807
        raise refuse(module, name)

    return __getattr__
