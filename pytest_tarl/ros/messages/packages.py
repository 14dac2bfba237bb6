"""Message packages as modules: `from geometry_msgs.msg import Twist`, each class built when it is asked for."""

from __future__ import annotations

from types import ModuleType
from typing import Any

from pytest_tarl.ros.messages import find_class, ros1, unknown_type
from pytest_tarl.ros.messages.definitions import Kind, message_names, service_names

_ENDINGS = ("_msgs", "_srvs", "_interfaces")
_OTHERS = ("turtlesim",)


def could_be_package(name: str) -> bool:
    """Tell by the name alone whether this may be a message package: most imports are none and must stay cheap."""
    return name.endswith(_ENDINGS) or name in _OTHERS


def is_package(kind: Kind, package: str) -> bool:
    """Tell whether definitions of this message package are known."""
    return bool(message_names(kind, package) or service_names(kind, package))


class PackagePart(ModuleType):
    """`package.msg` or `package.srv`."""

    def __init__(self, kind: Kind, package: str, part: str) -> None:
        super().__init__(f"{package}.{part}", f"Types of {package}, built from their definitions.")
        self._kind, self._package, self._part = kind, package, part
        self.__path__: list[str] = []

    def __getattr__(self, name: str) -> Any:
        if name == "__all__":
            return list(
                message_names(self._kind, self._package) if self._part == "msg" else self._service_names()
            )
        if name.startswith("__"):
            raise AttributeError(name)
        found = find_class(self._kind, self._package, name, self._part) or self._half_of_service(name)
        if found is None:
            raise unknown_type(self._package, name)
        setattr(self, name, found)
        return found

    def _service_names(self) -> list[str]:
        names = service_names(self._kind, self._package)
        halves = (
            [name + half for name in names for half in ("Request", "Response")]
            if self._kind == "ros1"
            else []
        )
        return sorted([*names, *halves])

    def _half_of_service(self, name: str) -> Any:
        """ROS 1 has `SetBoolRequest` and `SetBoolResponse` beside `SetBool`."""
        for suffix, attribute in (("Request", "_request_class"), ("Response", "_response_class")):
            if self._kind == "ros1" and self._part == "srv" and name.endswith(suffix):
                return getattr(ros1.service_class(self._package, name.removesuffix(suffix)), attribute, None)
        return None


def package_module(kind: Kind, name: str) -> ModuleType | None:
    """Make the module of that dotted name; None if it is no part of a message package."""
    package, _, part = name.partition(".")
    if not is_package(kind, package):
        return None
    if part in ("msg", "srv"):
        return PackagePart(kind, package, part)
    if part:
        return None
    module = ModuleType(package, f"Message package {package}, built from definitions.")
    module.__path__ = []
    return module
