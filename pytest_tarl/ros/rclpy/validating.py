"""rclpy's checks of names and types, such as `validate_topic_name` and `check_is_valid_msg_type`."""

from __future__ import annotations

from typing import Any, Literal

from pytest_tarl import ros_names
from pytest_tarl.ros import names
from pytest_tarl.ros.rclpy.exceptions import (
    InvalidNamespaceException,
    InvalidNodeNameException,
    InvalidParameterException,
    InvalidServiceNameException,
    InvalidTopicNameException,
    NoTypeSupportImportedException,
)
from pytest_tarl.ros_names import Problem

TOPIC_SEPARATOR_STRING = "/"
HIDDEN_TOPIC_PREFIX = "_"


def _require(problem: Problem | None, name: str, error: type[Any]) -> Literal[True]:
    if problem is not None:
        raise error(name, *problem)
    return True


def validate_topic_name(name: str, *, is_service: bool = False) -> Literal[True]:
    """Return True for a valid topic name. Raise InvalidTopicNameException or InvalidServiceNameException."""
    error = InvalidServiceNameException if is_service else InvalidTopicNameException
    return _require(ros_names.topic_problem(name), name, error)


def validate_full_topic_name(name: str, *, is_service: bool = False) -> Literal[True]:
    """Return True for a valid absolute name. Raise InvalidTopicNameException or InvalidServiceNameException."""
    error = InvalidServiceNameException if is_service else InvalidTopicNameException
    return _require(ros_names.full_topic_problem(name), name, error)


def validate_namespace(namespace: str) -> Literal[True]:
    """Return True for a valid namespace. Raise InvalidNamespaceException."""
    return _require(ros_names.namespace_problem(namespace), namespace, InvalidNamespaceException)


def validate_node_name(node_name: str) -> Literal[True]:
    """Return True for a valid node name. Raise InvalidNodeNameException."""
    return _require(ros_names.node_problem(node_name), node_name, InvalidNodeNameException)


def validate_parameter_name(name: str) -> Literal[True]:
    """Return True for a valid parameter name. Raise InvalidParameterException."""
    if not name:
        raise InvalidParameterException(name)
    return True


def expand_topic_name(topic_name: str, node_name: str, node_namespace: str) -> str:
    """Return the absolute name of a topic used in a node."""
    return names.expand(topic_name, names.absolute(f"{node_namespace}/{node_name}"))


def topic_or_service_is_hidden(name: str) -> bool:
    """Return whether a part of a name begins with an underscore."""
    return any(part.startswith(HIDDEN_TOPIC_PREFIX) for part in name.split(TOPIC_SEPARATOR_STRING))


def check_for_type_support(msg_or_srv_type: Any) -> None:
    """Accept classes of messages, services and actions. Raise NoTypeSupportImportedException for others."""
    parts = ("_fields_and_field_types", "Request", "Goal")
    if not any(hasattr(msg_or_srv_type, part) for part in parts):
        raise NoTypeSupportImportedException


def _check(part: str, kind: str, found: Any) -> None:
    if not hasattr(found, part):
        raise RuntimeError(f"The passed {kind} type is invalid: {found!r}")


def check_is_valid_msg_type(msg_type: Any) -> None:
    """Raise RuntimeError unless `msg_type` is a message class."""
    _check("_fields_and_field_types", "message", msg_type)


def check_is_valid_srv_type(srv_type: Any) -> None:
    """Raise RuntimeError unless `srv_type` is a service class."""
    _check("Request", "service", srv_type)
