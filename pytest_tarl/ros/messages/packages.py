"""Message packages as modules: `from geometry_msgs.msg import Twist` builds the class on first use."""

from __future__ import annotations

from importlib import import_module
from types import ModuleType
from typing import Any

from pytest_tarl.ros.messages import find_class, ros1, unknown_type
from pytest_tarl.ros.messages.definitions import Kind, contained_packages, type_names
from pytest_tarl.ros.messages.known import Part
from pytest_tarl.ros.messages.workspace import workspace_packages

_ENDINGS = ("_msgs", "_srvs", "_interfaces")
_OTHERS = {"turtlesim", "rospy_tutorials", "actionlib_tutorials", "beginner_tutorials", "turtle_actionlib",
           "roscpp_tutorials", "laser_assembler", "roscpp", "bond", "theora_image_transport", "sound_play"}  # fmt: skip
PARTS: tuple[Part, ...] = ("msg", "srv", "action")
_GENERATED = ("codecs", "genpy", "struct", "sys")  # what every module that genpy generates imports


def could_be_package(name: str) -> bool:
    """Return whether a name could be a message package.

    The check must be cheap, because most imported modules are not message packages.
    """
    return name.endswith(_ENDINGS) or name in _OTHERS or name in workspace_packages()


def is_package(kind: Kind, package: str) -> bool:
    """Return whether definitions of this message package are known."""
    return any(type_names(kind, package, part) for part in PARTS)


class PackagePart(ModuleType):
    """`package.msg`, `package.srv` or `package.action`."""

    def __init__(self, kind: Kind, package: str, part: Part) -> None:
        super().__init__(f"{package}.{part}", f"Types of {package}, built from definitions.")
        self._kind, self._package, self._part = kind, package, part
        self.__path__: list[str] = []

    def __getattr__(self, name: str) -> Any:
        if name == "__all__":
            return [*self._names(), *self._modules()]
        if name.startswith("__"):
            raise AttributeError(name)
        found = find_class(self._kind, self._package, name, self._part) or self._half_of_service(name)
        if found is None and name in self._modules():
            return import_module(name)
        if found is None:
            raise unknown_type(self._package, name)
        setattr(self, name, found)
        return found

    def _names(self) -> list[str]:
        names = type_names(self._kind, self._package, self._part)
        halves = ("Request", "Response") if self._kind == "ros1" and self._part == "srv" else ()
        return sorted([*names, *(name + half for name in names for half in halves)])

    def _modules(self) -> list[str]:
        """Return the modules that `import *` also binds: those that genpy's modules of ROS 1 import."""
        if self._kind == "ros2":
            return []
        return sorted({*_GENERATED, *contained_packages(self._package, self._part)})

    def _half_of_service(self, name: str) -> Any:
        """Return `SetBoolRequest` or `SetBoolResponse` of a ROS 1 service `SetBool`, or None for other names."""
        for suffix, attribute in (("Request", "_request_class"), ("Response", "_response_class")):
            if self._kind == "ros1" and self._part == "srv" and name.endswith(suffix):
                return getattr(ros1.service_class(self._package, name.removesuffix(suffix)), attribute, None)
        return None


class MessagePackage(ModuleType):
    """`package`.

    The parts of the package are available without an explicit import, as in ROS, where messages import each other.
    """

    def __init__(self, kind: Kind, package: str) -> None:
        super().__init__(package, f"Message package {package}, built from definitions.")
        self._kind = kind
        self.__path__: list[str] = []

    def __getattr__(self, name: str) -> Any:
        for part in PARTS:
            if name == part and type_names(self._kind, self.__name__, part):
                return import_module(f"{self.__name__}.{part}")
        raise AttributeError(f"module {self.__name__!r} has no attribute {name!r}")


def package_module(kind: Kind, name: str) -> ModuleType | None:
    """Create the module with that dotted name, or return None if it is not part of a message package."""
    package, _, part = name.partition(".")
    if not is_package(kind, package):
        return None
    for known in PARTS:
        if part == known:
            return PackagePart(kind, package, known)
        if part.startswith(f"{known}._"):  # as in `from std_msgs.msg._String import String`
            return PackagePart(kind, package, known)
    if part:
        return None
    return MessagePackage(kind, package)
