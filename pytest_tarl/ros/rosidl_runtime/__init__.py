"""rosidl_runtime_py: look up ROS 2 types by name, convert messages to dictionaries and YAML, and fill them."""

from pytest_tarl.ros.rosidl_runtime.convert import message_to_csv, message_to_ordereddict, message_to_yaml
from pytest_tarl.ros.rosidl_runtime.set_message import set_message_fields

__all__ = ["message_to_csv", "message_to_ordereddict", "message_to_yaml", "set_message_fields"]
