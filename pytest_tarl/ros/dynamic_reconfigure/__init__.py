"""dynamic_reconfigure, for parameters that change at run time: server, client, and generated configurations."""

from __future__ import annotations

from typing import Any

__all__ = ["DynamicReconfigureException", "find_reconfigure_services", "get_parameter_names"]


class DynamicReconfigureException(Exception):  # noqa: N818 (dynamic_reconfigure's name)
    """Base of the errors."""


class DynamicReconfigureParameterException(DynamicReconfigureException):
    """A parameter does not exist or cannot take a value."""


class DynamicReconfigureCallbackException(DynamicReconfigureException):
    """A callback failed."""


def find_reconfigure_services() -> list[str]:
    """Return the sorted names of the nodes with reconfigurable parameters."""
    from pytest_tarl.ros.tools import graph

    return sorted(
        name.removesuffix("/set_parameters") for name in graph.services() if name.endswith("/set_parameters")
    )


def get_parameter_names(config: dict[str, Any]) -> list[str]:
    """Return the names of a configuration's parameters."""
    return list(config.keys())
