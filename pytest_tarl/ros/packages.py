"""ament_index_python, rospkg and roslib.packages: find packages by the package.xml files around the nodes."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

from pytest_tarl.ros.messages.workspace import package_folders, packages
from pytest_tarl.ros.missing import refuse

__all__ = [
    "InvalidROSPkgException",
    "PackageNotFoundError",
    "ResourceNotFound",
    "RosPack",
    "get_package_prefix",
    "get_package_share_directory",
    "get_package_share_path",
    "get_packages_with_prefixes",
    "get_pkg_dir",
    "on_ros_path",
]  # fmt: skip


class PackageNotFoundError(KeyError):
    """The package is not in the node's repository (ament's exception)."""


class ResourceNotFound(Exception):  # noqa: N818
    """The package is not in the node's repository (rospkg's exception)."""


class InvalidROSPkgException(Exception):  # noqa: N818
    """The package is not in the node's repository (roslib's exception)."""


def _folder(package: str) -> Path | None:
    return package_folders().get(package)


def get_package_share_directory(package_name: str) -> str:
    """Return a package's source folder, which stands in for its share directory. Raises PackageNotFoundError."""
    found = _folder(package_name)
    if found is None:
        raise PackageNotFoundError(f"package '{package_name}' not found, looked in the node's repository")
    return str(found)


def get_package_share_path(package_name: str) -> Path:
    """Return a package's source folder as a Path."""
    return Path(get_package_share_directory(package_name))


def get_package_prefix(package_name: str) -> str:
    """Return a package's source folder."""
    return get_package_share_directory(package_name)


def get_packages_with_prefixes() -> dict[str, str]:
    """Return all packages and their folders."""
    return {name: str(folder) for name, folder in package_folders().items()}


def get_pkg_dir(package: str, required: bool = True) -> str | None:
    """Return a package's folder, as roslib does. Raises InvalidROSPkgException if it is unknown."""
    found = _folder(package)
    if found is None and required:
        raise InvalidROSPkgException(f"cannot locate package {package!r} in the node's repository")
    return None if found is None else str(found)


def on_ros_path(p: str) -> bool:
    """Return whether a path is in a package."""
    return any(Path(p).is_relative_to(folder) for folder in package_folders().values())


class RosPack:
    """rospkg's view of the packages."""

    def get_path(self, name: str) -> str:
        """Return a package's folder. Raises ResourceNotFound if it is unknown."""
        found = _folder(name)
        if found is None:
            raise ResourceNotFound(name)
        return str(found)

    def list(self) -> Any:
        """List the packages."""
        return [*package_folders()]

    def get_depends(self, name: str, implicit: bool = True) -> Any:  # noqa: ARG002 (rospkg's signature)
        """List a package's dependencies from its manifest."""
        self.get_path(name)
        return [*packages()[name].dependencies]


def __getattr__(name: str) -> Any:
    """Raise for a name that the stand-in lacks."""
    raise refuse(str(sys._getframe(1).f_globals.get("__name__", "rospkg")), name)
