"""The exceptions of rclpy."""

# ruff: noqa: ARG002 (signatures are rclpy's)

from __future__ import annotations

from typing import Any


class NotInitializedException(Exception):  # noqa: N818 (these names are rclpy's)
    """A function was called before `rclpy.init`."""

    def __init__(self, *_: Any) -> None:
        super().__init__("rclpy.init() has not been called", *_)


class RCLError(RuntimeError):
    """An error from rcl, the C layer below rclpy."""

    tarl_shutdown = False


class NameValidationException(Exception):  # noqa: N818
    """A name has invalid characters."""

    def __init__(self, name_type: str, name: str, error_msg: str, invalid_index: int = 0) -> None:
        pointer = " " * invalid_index + "^"
        super().__init__(f"Invalid {name_type}: {error_msg}:\n  {name!r}\n   {pointer}")
        self.name_type, self.name = name_type, name
        self.error_msg, self.invalid_index = error_msg, invalid_index


class InvalidNamespaceException(NameValidationException):
    """A namespace is not valid."""

    def __init__(self, name: str, error_msg: str, invalid_index: int = 0) -> None:
        super().__init__("namespace", name, error_msg, invalid_index)


class InvalidNodeNameException(NameValidationException):
    """A node name is not valid."""

    def __init__(self, name: str, error_msg: str, invalid_index: int = 0) -> None:
        super().__init__("node name", name, error_msg, invalid_index)


class InvalidTopicNameException(NameValidationException):
    """A topic name is not valid."""

    def __init__(self, name: str, error_msg: str, invalid_index: int = 0) -> None:
        super().__init__("topic name", name, error_msg, invalid_index)


class InvalidServiceNameException(NameValidationException):
    """A service name is not valid."""

    def __init__(self, name: str, error_msg: str, invalid_index: int = 0) -> None:
        super().__init__("service name", name, error_msg, invalid_index)


class InvalidHandle(RuntimeError):  # noqa: N818
    """A destroyed entity was used."""


class TimerCancelledError(RuntimeError):
    """A timer was called after it was cancelled."""


class NoTypeSupportImportedException(Exception):  # noqa: N818
    """An argument is not a message type."""


class ParameterException(Exception):  # noqa: N818
    """Base of parameter errors."""

    def __init__(self, error_msg: str, parameters: Any = None, *args: Any) -> None:
        super().__init__(f"{error_msg}: {parameters}" if parameters is not None else error_msg, *args)


class ParameterNotDeclaredException(ParameterException):
    """An undeclared parameter was read or set."""

    def __init__(self, parameters: Any, *args: Any) -> None:
        super().__init__("Invalid access to undeclared parameter(s)", parameters, *args)


class ParameterAlreadyDeclaredException(ParameterException):
    """A parameter was declared twice."""

    def __init__(self, parameters: Any, *args: Any) -> None:
        super().__init__("Parameter(s) already declared", parameters, *args)


class ParameterUninitializedException(ParameterException):
    """A statically typed parameter was read before it had a value."""

    def __init__(self, parameter_name: str, *args: Any) -> None:
        super().__init__("The parameter is not initialized", parameter_name, *args)


class InvalidParameterException(ParameterException):
    """A parameter name is not valid."""

    def __init__(self, parameter: Any, *args: Any) -> None:
        super().__init__("Invalid parameter name", parameter, *args)


class InvalidParameterTypeException(ParameterException):
    """A parameter was set to a value that is not of its declared type."""

    def __init__(self, parameter: Any, expected: Any, *args: Any) -> None:
        name, given = parameter.name, parameter.type_.name
        super().__init__(f"Trying to set parameter '{name}' to '{parameter.value}' of type '{given}', "
                         f"expecting type '{expected}'")  # fmt: skip


class InvalidParameterValueException(ParameterException):
    """A parameter callback rejected a value."""

    def __init__(self, parameter: Any, value: Any, reason: str, *args: Any) -> None:
        super().__init__(f"Invalid parameter value ({value}) for parameter. Reason: {reason}", parameter)


class ParameterImmutableException(ParameterException):
    """A read-only parameter was set or undeclared."""

    def __init__(self, parameter_name: str, *args: Any) -> None:
        super().__init__("Attempted to modify read-only parameter", parameter_name, *args)


class ROSInterruptException(Exception):  # noqa: N818
    """A wait was interrupted by the node's shutdown."""

    tarl_shutdown = True
