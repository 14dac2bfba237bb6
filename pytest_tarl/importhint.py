"""Advice for a test module that imports ROS when no ROS is installed."""

from __future__ import annotations

from pytest_tarl.ros.messages.package_modules import could_be_package
from pytest_tarl.ros.standins import STANDINS


def package_hint(error: BaseException | None) -> str | None:
    """Return advice if a test was not collected because its package's `__init__.py` imports ROS, or None."""
    if import_hint(error) is None:
        return None
    return (
        "The test is in a Python package whose __init__.py imports ROS. pytest imports this file before the test, when "
        "TARL provides no ROS yet: move the test to a folder outside the package."
    )


def import_hint(error: BaseException | None) -> str | None:
    """Return advice on an import that failed during collection; None for other errors."""
    while error is not None:
        advice = _of_module(error.name) if isinstance(error, ModuleNotFoundError) and error.name else None
        if advice is not None:
            return advice
        error = error.__cause__ or error.__context__
    return None


def _of_module(name: str) -> str | None:
    """Return advice on a module of ROS; None for other modules."""
    package = name.partition(".")[0]
    if package in STANDINS:
        return (
            f"{package} is not installed, and TARL provides it only to nodes while a test runs: import the node "
            "inside the test function or start it by tarl.start, and communicate with it through tarl.bus."
        )
    if could_be_package(package):
        return (
            f"{package} is not installed, and TARL provides it only to nodes while a test runs: in a test write "
            f"message_type('{package}/msg/TYPE'), from pytest_tarl.ros; '{package}/TYPE' is the type of ROS 1."
        )
    return None
