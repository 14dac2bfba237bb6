"""dynamic_reconfigure.server.Server."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from pytest_tarl.ros.dynamic_reconfigure.encoding import (
    Config,
    checked,
    decode_config,
    described,
    encode_config,
    level_of,
)
from pytest_tarl.ros.messages import find_class, message_type
from pytest_tarl.ros.rospy.node import this_node
from pytest_tarl.ros.rospy.parameters import get_param, set_param
from pytest_tarl.ros.rospy.services import Service
from pytest_tarl.ros.rospy.topics import Publisher

_EVERYTHING = 0xFFFFFFFF  # level of the first call: all bits set


class Server:
    """Calls `callback(config, level)` at the start and after each change; the returned configuration is used."""

    def __init__(self, type: Any, callback: Callable[[Config, int], Any], namespace_prefix: str = "") -> None:  # noqa: A002
        self.type = type
        self.callback = callback
        node = this_node("dynamic_reconfigure.server.Server")
        self.ns = f"{node.name}/{namespace_prefix}".rstrip("/")
        defaults = {name: one["default"] for name, one in described(type).items()}
        given = {name: get_param(f"{self.ns}/{name}", value) for name, value in defaults.items()}
        for name, value in given.items():
            node.process.ros.read(f"{self.ns}/{name}", value)
        self.config = Config(defaults)
        self._pub = Publisher(
            f"{self.ns}/parameter_updates", message_type("dynamic_reconfigure/Config"), latch=True
        )
        self._change(checked(type, given), _EVERYTHING)
        service = find_class("ros1", "dynamic_reconfigure", "Reconfigure", "srv")
        self._service = Service(f"{self.ns}/set_parameters", service, self._asked)

    def update_configuration(self, changes: dict[str, Any]) -> Config:
        """Change some parameters from inside the node."""
        new = Config({**self.config, **checked(self.type, changes)})
        return self._change(new, level_of(self.type, self.config, new))

    def _asked(self, request: Any) -> Any:
        return encode_config(self.update_configuration(decode_config(request.config)))

    def _change(self, new: Config, level: int) -> Config:
        self.config = Config(checked(self.type, self.callback(new, level)))
        for name, value in self.config.items():
            set_param(f"{self.ns}/{name}", value)
        self._pub.publish(encode_config(self.config))
        return self.config
