"""The parameters of a node: declared, typed, overridden from outside, guarded by callbacks."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any

from pytest_tarl.ros.messages import find_class
from pytest_tarl.ros.rclpy.exceptions import (
    InvalidParameterException,
    InvalidParameterTypeException,
    InvalidParameterValueException,
    ParameterAlreadyDeclaredException,
    ParameterNotDeclaredException,
    ParameterUninitializedException,
)
from pytest_tarl.ros.rclpy.parameter import Parameter, ParameterType

SetCallback = Callable[[list[Parameter]], Any]


def outcome(successful: bool, reason: str = "") -> Any:
    """Make rcl_interfaces/SetParametersResult."""
    made: Any = find_class("ros2", "rcl_interfaces", "SetParametersResult")
    return made(successful=successful, reason=reason)


class NodeParameters:
    """The part of a node that knows its parameters."""

    def __init__(self, overrides: dict[str, Any], allow_undeclared: bool) -> None:
        self._parameters: dict[str, Parameter] = {}
        self._dynamic: set[str] = set()
        self._parameter_overrides = overrides
        self._allow_undeclared = allow_undeclared
        self._set_callbacks: list[SetCallback] = []
        self._post_set_callbacks: list[SetCallback] = []
        self.declare_parameter("use_sim_time", False)

    def declare_all_overrides(self) -> None:
        """Declare every parameter that was given from outside."""
        for name, value in self._parameter_overrides.items():
            if name not in self._parameters:
                self.declare_parameter(name, value)

    def declare_parameter(
        self, name: str, value: Any = None, descriptor: Any = None, ignore_override: bool = False
    ) -> Parameter:
        """Declare a parameter: its value from outside wins over the default; its type stays from then on."""
        if not name or not isinstance(name, str):
            raise InvalidParameterException(name)
        if name in self._parameters:
            raise ParameterAlreadyDeclaredException(name)
        wanted = value if isinstance(value, ParameterType) else None
        default = None if wanted is not None else value
        given = default if ignore_override else self._parameter_overrides.get(name, default)
        parameter = Parameter(name, value=given)
        expected = wanted or (Parameter(name, value=default).type_ if default is not None else None)
        dynamic = descriptor is not None and descriptor.dynamic_typing
        if not dynamic and expected is not None and given is not None and not _fits(parameter, expected):
            raise InvalidParameterTypeException(parameter, expected.name)
        if given is not None:
            self._ask_callbacks([parameter], raising=True)
        if dynamic or (value is None and given is None):
            self._dynamic.add(name)
        self._parameters[name] = parameter
        return parameter

    def declare_parameters(
        self, namespace: str, parameters: Iterable[tuple[Any, ...]], ignore_override: bool = False
    ) -> list[Parameter]:
        """Declare several, given as (name), (name, value) or (name, value, descriptor)."""
        declared = []
        for entry in parameters:
            name, value, descriptor = (*entry, None, None)[:3]
            full = f"{namespace}.{name}" if namespace else name
            declared.append(self.declare_parameter(full, value, descriptor, ignore_override))
        return declared

    def undeclare_parameter(self, name: str) -> None:
        """Forget a parameter."""
        if name not in self._parameters:
            raise ParameterNotDeclaredException(name)
        del self._parameters[name]

    def has_parameter(self, name: str) -> bool:
        """Tell whether a parameter is declared."""
        return name in self._parameters

    def get_parameter(self, name: str) -> Parameter:
        """Return a parameter. Raises ParameterNotDeclaredException."""
        parameter = self._parameters.get(name)
        if parameter is None:
            if self._allow_undeclared:
                return Parameter(name)
            raise ParameterNotDeclaredException(name)
        if parameter.value is None and name not in self._dynamic:
            raise ParameterUninitializedException(name)
        return parameter

    def get_parameters(self, names: list[str]) -> list[Parameter]:
        """Return several parameters."""
        return [self.get_parameter(name) for name in names]

    def get_parameter_or(self, name: str, alternative_value: Parameter | None = None) -> Parameter:
        """Return a parameter, or the alternative where it is not declared or has no value."""
        parameter = self._parameters.get(name)
        if parameter is None or parameter.value is None:
            return alternative_value if alternative_value is not None else Parameter(name)
        return parameter

    def get_parameters_by_prefix(self, prefix: str) -> dict[str, Parameter]:
        """Return the parameters below a prefix, by the rest of their names."""
        start = f"{prefix}." if prefix else ""
        return {name[len(start) :]: p for name, p in self._parameters.items() if name.startswith(start)}

    def get_parameter_type(self, name: str) -> ParameterType:
        """Return the type of a parameter."""
        return self.get_parameter(name).type_

    def set_parameters(self, parameter_list: list[Parameter]) -> list[Any]:
        """Set parameters one by one; each result tells whether it was accepted."""
        return [self._set([parameter]) for parameter in parameter_list]

    def set_parameters_atomically(self, parameter_list: list[Parameter]) -> Any:
        """Set all parameters or none."""
        return self._set(parameter_list)

    def add_on_set_parameters_callback(self, callback: SetCallback) -> None:
        """Ask `callback` before parameters change; the newest is asked first."""
        self._set_callbacks.insert(0, callback)

    def remove_on_set_parameters_callback(self, callback: SetCallback) -> None:
        """Do not ask `callback` any more."""
        self._set_callbacks.remove(callback)

    def add_post_set_parameters_callback(self, callback: SetCallback) -> None:
        """Tell `callback` after parameters have changed."""
        self._post_set_callbacks.insert(0, callback)

    def remove_post_set_parameters_callback(self, callback: SetCallback) -> None:
        """Do not tell `callback` any more."""
        self._post_set_callbacks.remove(callback)

    def _set(self, parameters: list[Parameter]) -> Any:
        for parameter in parameters:
            known = self._parameters.get(parameter.name)
            if known is None and not self._allow_undeclared:
                raise ParameterNotDeclaredException(parameter.name)
            if (
                known is not None
                and parameter.name not in self._dynamic
                and not _fits(parameter, known.type_)
            ):
                reason = f"Wrong parameter type, expected '{known.type_}' got '{parameter.type_}'"
                return outcome(False, reason)
        result = self._ask_callbacks(parameters)
        if result.successful:
            self._parameters.update({parameter.name: parameter for parameter in parameters})
            for callback in tuple(self._post_set_callbacks):
                callback(parameters)
        return result

    def _ask_callbacks(self, parameters: list[Parameter], *, raising: bool = False) -> Any:
        for callback in tuple(self._set_callbacks):
            result = callback(parameters)
            if not result.successful:
                if raising:
                    raise InvalidParameterValueException(
                        parameters[0].name, parameters[0].value, result.reason
                    )
                return result
        return None if raising else outcome(True)


def _fits(parameter: Parameter, expected: ParameterType) -> bool:
    """Tell whether a value has the declared type; an empty list fits every array."""
    if expected == ParameterType.NOT_SET or parameter.type_ == expected:
        return True
    return (
        expected.name.endswith("ARRAY") and isinstance(parameter.value, list | tuple) and not parameter.value
    )
