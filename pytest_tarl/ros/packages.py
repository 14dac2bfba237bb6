"""ament_index_python, rospkg and roslib.packages: find packages by the package.xml files around the nodes."""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from pytest_tarl.ros.messages.node_workspaces import package_folders, packages, workspaces

__all__ = [
    "InvalidROSPkgException",
    "PackageNotFoundError",
    "ResourceNotFound",
    "RosPack",
    "find_node",
    "find_resource",
    "get_dir_pkg",
    "get_log_dir",
    "get_package_name",
    "get_package_prefix",
    "get_package_share_directory",
    "get_package_share_path",
    "get_packages_with_prefixes",
    "get_pkg_dir",
    "get_ros_home",
    "get_ros_package_path",
    "on_ros_path",
]  # fmt: skip


class PackageNotFoundError(KeyError):
    """The package is not in the node's repository (ament's exception)."""


class ResourceNotFound(Exception):  # noqa: N818
    """The package is not in the node's repository (rospkg's exception)."""


class InvalidROSPkgException(Exception):  # noqa: N818
    """The package is not in the node's repository (roslib's exception)."""


def _absent(package: str) -> str:
    """Return the sentence for a package whose folder is unknown."""
    markers = [marker for one in workspaces() if (marker := one.marker_of(package)) is not None]
    if markers:
        return f"package '{package}' not found: {markers[0]} hides it from the build; delete that file"
    within = " and ".join(str(one.root) for one in workspaces()) or "the node's repository"
    return (
        f"package '{package}' not found in {within}: put a checkout of it, or a folder with its package.xml and the "
        "files that the node reads, below it"
    )


def _folder(package: str) -> Path | None:
    return package_folders().get(package)


def get_package_share_directory(package_name: str) -> str:
    """Return a package's source folder instead of its share directory. Raise PackageNotFoundError."""
    found = _folder(package_name)
    if found is None:
        raise PackageNotFoundError(_absent(package_name))
    return str(found)


def get_package_share_path(package_name: str) -> Path:
    """Return a package's source folder as a Path."""
    return Path(get_package_share_directory(package_name))


def get_package_prefix(package_name: str) -> str:
    """Return a package's source folder."""
    return get_package_share_directory(package_name)


def get_packages_with_prefixes() -> dict[str, str]:
    """Return all packages with their folders."""
    return {name: str(folder) for name, folder in package_folders().items()}


def get_pkg_dir(package: str, required: bool = True) -> str | None:
    """Return a package's folder, as roslib does. Raise InvalidROSPkgException if the package is unknown."""
    found = _folder(package)
    if found is None and required:
        raise InvalidROSPkgException(_absent(package))
    return None if found is None else str(found)


def get_package_name(path: str) -> str | None:
    """Return the name of the package that contains a path, or None."""
    place = Path(path).resolve()
    around = [
        (len(folder.parts), name)
        for name, folder in package_folders().items()
        if place.is_relative_to(folder)
    ]
    return max(around)[1] if around else None


def get_dir_pkg(d: str) -> tuple[str | None, str | None]:
    """Return folder and name of the package that contains a path, or (None, None)."""
    name = get_package_name(d)
    return (None, None) if name is None else (str(_folder(name)), name)


def get_log_dir(env: Mapping[str, str] | None = None) -> str:
    """Return the folder for ROS's logs: `ROS_LOG_DIR`, or `log` in `get_ros_home`."""
    return (os.environ if env is None else env).get("ROS_LOG_DIR") or str(Path(get_ros_home(env)) / "log")


def get_ros_home(env: Mapping[str, str] | None = None) -> str:
    """Return the folder for ROS's logs and settings: `ROS_HOME`, or `.ros` in the home folder."""
    given = os.environ if env is None else env
    return given.get("ROS_HOME") or str(Path.home() / ".ros")


def get_ros_package_path(env: Mapping[str, str] | None = None) -> str | None:
    """Return the variable `ROS_PACKAGE_PATH`."""
    return (os.environ if env is None else env).get("ROS_PACKAGE_PATH")


def find_node(pkg: str, node_type: str) -> list[str]:
    """Return the paths of a package's executables with this name. Raise InvalidROSPkgException if it is unknown."""
    return [found for found in find_resource(pkg, node_type) if os.access(found, os.X_OK)]


def find_resource(pkg: str, resource_name: str) -> list[str]:
    """Return the paths of a package's files with this name. Raise InvalidROSPkgException if it is unknown."""
    folder = Path(str(get_pkg_dir(pkg)))
    named = folder / resource_name
    inside = [one for one in sorted(folder.rglob(named.name)) if one.is_file() and one != named]
    return [str(one) for one in ([named] if named.is_file() else []) + inside]


def on_ros_path(p: str) -> bool:
    """Return whether a path is in a package."""
    return any(Path(p).is_relative_to(folder) for folder in package_folders().values())


class RosPack:
    """rospkg's view of the packages."""

    def get_path(self, name: str) -> str:
        """Return a package's folder. Raise ResourceNotFound if the package is unknown."""
        found = _folder(name)
        if found is None:
            raise ResourceNotFound(_absent(name))
        return str(found)

    def list(self) -> Any:
        """List the packages."""
        return [*package_folders()]

    def get_depends(self, name: str, implicit: bool = True) -> Any:  # noqa: ARG002 (rospkg's signature)
        """List a package's dependencies from its manifest."""
        self.get_path(name)
        return [*packages()[name].dependencies]
