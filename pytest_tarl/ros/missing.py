"""Errors for APIs that the in-process ROS does not implement."""

from __future__ import annotations

from collections.abc import Callable

from pytest_tarl.errors import UnsupportedApiError


def unsupported(api: str) -> UnsupportedApiError:
    """Return the error for an API that is not implemented, with advice."""
    return UnsupportedApiError(
        f"{api} is not in the in-process ROS yet: give the node a small stand-in for it in your test (monkeypatch "
        "the call, or put a module of that name into sys.modules), or drive the node through the parts that are there."
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
