"""Resolve module names to files, even if several files have the same name."""

from __future__ import annotations

import posixpath
import sys
from collections.abc import Iterable, Mapping
from typing import Final, Generic, Protocol, TypeVar

LIBRARIES: Final = frozenset(
    ["rospy", "rclpy", "message_filters", "actionlib", "tf2_ros"]
)  # packages that the catalog describes

KNOWN: Final = (
    sys.stdlib_module_names | LIBRARIES | {"smach", "typing_extensions"}
)  # packages whose classes receive no data


def unfollowed(classes: Iterable[str]) -> tuple[str, ...]:
    """Return the classes that do not belong to Python or to the ROS packages in the catalog."""
    return tuple(name for name in classes if name.partition(".")[0] not in KNOWN)


class Named(Protocol):
    """A Python file, parsed or not."""

    @property
    def path(self) -> str:
        """Return the displayed path."""

    @property
    def name(self) -> str:
        """Return the dotted name."""

    @property
    def text(self) -> str:
        """Return the source."""

    @property
    def is_package(self) -> bool:
        """Return whether the file is a package's `__init__.py`."""

    @property
    def started(self) -> tuple[str, ...]:
        """Return the entry points that its package declares."""


M = TypeVar("M", bound=Named)


class Index(Generic[M]):
    """The modules of one run by dotted name; a monorepo may have several with the same name."""

    def __init__(self, modules: Iterable[M]) -> None:
        self._by_name: dict[str, list[M]] = {}
        for module in modules:
            self._by_name.setdefault(module.name, []).append(module)

    def find(self, name: str, importer: Named) -> M | None:
        """Return the module that `importer` imports; of several with this name, the one with the longest common path.

        Names of packages in the catalog never refer to source files, even if these are among the files.
        """
        candidates = self._by_name.get(name) or self._beside(name, importer)
        if not candidates or name.partition(".")[0] in LIBRARIES:
            return None
        if len(candidates) == 1:
            return candidates[0]
        return max(candidates, key=lambda m: (_shared(m.path, importer.path), m.path))

    def _beside(self, name: str, importer: Named) -> list[M]:
        """Return the modules in the directory of a package's file that is run as a script."""
        package = importer.name if importer.is_package else importer.name.rpartition(".")[0]
        if not package or name.partition(".")[0] in sys.stdlib_module_names:
            return []
        return self._by_name.get(f"{package}.{name}", [])

    @property
    def names(self) -> Mapping[str, list[M]]:
        """Return the modules by name."""
        return self._by_name


def _shared(a: str, b: str) -> int:
    """Return the number of leading directories that two paths share."""
    pairs = zip(posixpath.dirname(a).split("/"), posixpath.dirname(b).split("/"), strict=False)
    count = 0
    for x, y in pairs:
        if x != y:
            break
        count += 1
    return count
