"""Advice for a node that imports a module which neither this interpreter nor the workspace has."""

from __future__ import annotations

from pytest_tarl.ros.messages.workspace import packages, workspaces
from pytest_tarl.ros.uninstalled import candidates


def advice(error: BaseException) -> str:
    """Return one sentence on how to make a failed import work; empty for other errors."""
    if not isinstance(error, ModuleNotFoundError) or not error.name:
        return ""
    root, _, inner = error.name.partition(".")
    if inner:
        return ""  # the package is there, so the name is misspelled
    known = packages().get(root)
    if known is not None:
        return (
            f"The package {root} is in the workspace ({known.folder}), but installs no Python module of this name: "
            "name it in packages of its setup.py, or in ament_python_install_package."
        )
    places = candidates(root)
    if len(places) > 1:
        told = " and ".join(str(one) for one in places[:3])
        return f"No package installs {root}, and more than one file has this name ({told}): name one in a setup.py."
    within = " and ".join(str(one.root) for one in workspaces()) or "around the node"
    return (
        f"No package of the workspace {within} installs {root}, and it is not installed here: install it with pip, or "
        "put a replacement into sys.modules in the test."
    )
