"""Errors for APIs that the in-process ROS does not implement."""

from __future__ import annotations

import sys
from collections.abc import Mapping
from difflib import get_close_matches
from opcode import opmap
from types import FrameType
from typing import Final

from pytest_tarl.errors import (
    UnsupportedApiError,
    UnsupportedImportError,
    UnsupportedModuleError,
    UnsupportedNameError,
)

_STAND_IN: Final = (
    "give the node a small stand-in for it in your test (monkeypatch the call, or put a module of that name into "
    "sys.modules), or drive the node only through the parts that exist."
)
# minimum similarity of a suggested name: one letter in five to ten may differ
_ALIKE: Final = 0.8
_IMPORT_FROM: Final = opmap["IMPORT_FROM"]
_REPLACE: Final = "put a module of that name into sys.modules in your test"
_ADVICE: Final[Mapping[str, str]] = {  # package → what to use instead
    "roslaunch": f"since tarl.launch starts launch files: call it in the test, or {_REPLACE}.",
    "image_transport": f"since its plugins are compiled libraries: {_REPLACE}, or use rospy and cv_bridge.",
}


def unsupported(api: str) -> UnsupportedApiError:
    """Return the error for an API that is not implemented, with advice."""
    return UnsupportedApiError(_sentence(api))


def unsupported_name(api: str) -> UnsupportedNameError:
    """Return the error for a missing attribute, with advice; it is also an AttributeError."""
    return UnsupportedNameError(_sentence(api))


def unsupported_module(name: str) -> UnsupportedModuleError:
    """Return the error for a missing module, with advice; it is also a ModuleNotFoundError."""
    return UnsupportedModuleError(_sentence(name), name=name)


def _sentence(api: str) -> str:
    advice = _ADVICE.get(api.partition(".")[0])
    if advice is not None:
        return f"{api} is not in the in-process ROS, {advice}"
    return f"{api} is not in the in-process ROS yet: {_STAND_IN}"


def refuse(module: str, name: str) -> Exception:
    """Return the error for a name that a stand-in lacks; Python's own error for dunder names."""
    if name.startswith("__"):
        return AttributeError(f"module {module!r} has no attribute {name!r}")
    return UnsupportedNameError(_of_name(module, name))


def _of_name(module: str, name: str) -> str:
    """Return the message for a missing name, including whether the real ROS module has it."""
    from pytest_tarl.ros.lacking_names import LACKING

    api = f"{module}.{name}"
    if module in LACKING and not name.startswith("_"):
        if name in LACKING[module].split():
            return _sentence(api)
        here = [one for one in vars(sys.modules.get(module, sys)) if not one.startswith("_")]
        near = get_close_matches(name, here, 1, _ALIKE)
        guess = f". Did you mean {module}.{near[0]}?" if near else ": check its spelling."
        return f"{api} is not in the in-process ROS, and ROS has no such name either{guess}"
    return f"{api} is not in the in-process ROS: check its spelling. If ROS has it, {_STAND_IN}"


def as_read_by(frame: FrameType | None, error: Exception) -> Exception:
    """Return an ImportError instead of an UnsupportedNameError if the frame runs `from module import name`.

    Python itself would replace the AttributeError by an ImportError without advice.
    """
    if not isinstance(error, UnsupportedNameError) or frame is None:
        return error
    imports = frame.f_lasti >= 0 and frame.f_code.co_code[frame.f_lasti] == _IMPORT_FROM
    return UnsupportedImportError(*error.args) if imports else error
