"""dynamic_reconfigure.client.Client."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from pytest_tarl.ros.dynamic_reconfigure.encoding import Config, decode_config, encode_config
from pytest_tarl.ros.messages import find_class, message_type
from pytest_tarl.ros.rospy.node import this_node
from pytest_tarl.ros.rospy.services import ServiceProxy, wait_for_service
from pytest_tarl.ros.rospy.topics import Subscriber


class Client:
    """Reads and changes the parameters of another node."""

    def __init__(
        self,
        name: str,
        timeout: float | None = None,
        config_callback: Callable[[Config], Any] | None = None,
        **_: Any,
    ) -> None:
        self.name = this_node("dynamic_reconfigure.client.Client").resolve(name)
        self._config: Config | None = None
        self._callback = config_callback
        wait_for_service(f"{self.name}/set_parameters", timeout)
        self._proxy = ServiceProxy(
            f"{self.name}/set_parameters", find_class("ros1", "dynamic_reconfigure", "Reconfigure", "srv")
        )
        self._subscriber = Subscriber(
            f"{self.name}/parameter_updates", message_type("dynamic_reconfigure/Config"), self._take
        )

    def get_configuration(self, timeout: float | None = None) -> Config | None:  # noqa: ARG002
        """Return the server's last configuration."""
        return self._config

    def update_configuration(self, changes: dict[str, Any]) -> Config:
        """Change some parameters; return the resulting configuration."""
        return decode_config(self._proxy(encode_config(changes)).config)

    def get_config_callback(self) -> Callable[[Config], Any] | None:
        """Return the function that receives every configuration."""
        return self._callback

    def set_config_callback(self, value: Callable[[Config], Any] | None) -> None:
        """Set the function that receives every configuration; call it with the current one."""
        self._callback = value
        if value is not None and self._config is not None:
            value(self._config)

    config_callback = property(get_config_callback, set_config_callback)

    def close(self) -> None:
        """Stop receiving configurations."""
        self._subscriber.unregister()

    def _take(self, message: Any) -> None:
        self._config = decode_config(message)
        if self._callback is not None:
            self._callback(self._config)
