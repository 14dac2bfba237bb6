"""dynamic_reconfigure: parameters that change at run time; server, client, generated configurations."""

from __future__ import annotations

from typing import Any

from pytest_tarl.ros.missing import refuse

__all__: list[str] = []


class DynamicReconfigureParameterException(Exception):  # noqa: N818 (dynamic_reconfigure's name)
    """A parameter does not exist or cannot take a value."""


class DynamicReconfigureCallbackException(Exception):  # noqa: N818
    """A callback failed."""


def __getattr__(name: str) -> Any:
    """Raise for a name that the stand-in lacks."""
    raise refuse("dynamic_reconfigure", name)
