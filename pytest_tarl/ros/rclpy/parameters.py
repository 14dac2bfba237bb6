"""The parameters of a node: declaration, types, descriptors, overrides, callbacks."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from copy import deepcopy
from typing import Any

from pytest_tarl.ros.messages import find_class
from pytest_tarl.ros.process import running_process
from pytest_tarl.ros.rclpy.descriptors import fits, new_descriptor, objection
from pytest_tarl.ros.rclpy.exceptions import (
    InvalidParameterException,
    InvalidParameterTypeException,
    InvalidParameterValueException,
    ParameterAlreadyDeclaredException,
    ParameterImmutableException,
    ParameterNotDeclaredException,
    ParameterUninitializedException,
)
from pytest_tarl.ros.rclpy.parameter import Parameter, ParameterType

SetCallback = Callable[[list[Parameter]], Any]


def outcome(successful: bool, reason: str = "") -> Any:
    """Create rcl_interfaces/SetParametersResult."""
    made: Any = find_class("ros2", "rcl_interfaces", "SetParametersResult")
    return made(successful=successful, reason=reason)


class NodeParameters:
    """Mixin of Node: parameters."""

    def __init__(self, overrides: dict[str, Any], allow_undeclared: bool) -> None:
        self._parameters: dict[str, Parameter] = {}
        self._descriptors: dict[str, Any] = {}  # without a descriptor, only the value's type is fixed
        self._parameter_overrides = overrides
        self._allow_undeclared = allow_undeclared
        self._pre_set_callbacks: list[SetCallback] = []
        self._set_callbacks: list[SetCallback] = []
        self._post_set_callbacks: list[SetCallback] = []
        self._parameters["use_sim_time"] = Parameter("use_sim_time", value=False)

    def declare_all_overrides(self) -> None:
        """Declare every override, with a dynamic type."""
        for name, value in self._parameter_overrides.items():
            if name not in self._parameters:
                self.declare_parameter(name, value, new_descriptor(dynamic_typing=True))

    def declare_parameter(
        self, name: str, value: Any = None, descriptor: Any = None, ignore_override: bool = False
    ) -> Parameter:
        """Declare a parameter, whose type is then fixed. An override takes precedence over `value`.

        Raise ParameterAlreadyDeclaredException, InvalidParameterException for an invalid name, and
        InvalidParameterTypeException for a value of another type.
        """
        if not name or not isinstance(name, str):
            raise InvalidParameterException(name)
        if name in self._parameters:
            raise ParameterAlreadyDeclaredException(name)
        wanted = value if isinstance(value, ParameterType) else None
        default = None if wanted is not None else value
        given = default if ignore_override else self._parameter_overrides.get(name, default)
        parameter = Parameter(name, value=given)
        described = self._description(name, wanted, default, given, descriptor)
        if not described.dynamic_typing and given is not None and not fits(parameter, described.type):
            raise InvalidParameterTypeException(parameter, ParameterType(described.type).name)
        if given is not None:
            self._accept_declared(parameter, described)
        self._parameters[name] = parameter
        self._descriptors[name] = described
        self.parameters_changed([parameter], set())
        return parameter

    def _description(self, name: str, wanted: Any, default: Any, given: Any, descriptor: Any) -> Any:
        described = deepcopy(descriptor) if descriptor is not None else new_descriptor()
        described.name = name
        if wanted is None and default is None and given is None:
            described.dynamic_typing = True
        if not described.dynamic_typing:
            known = wanted or Parameter(name, value=default if default is not None else given).type_
            described.type = int(known)
        return described

    def _accept_declared(self, parameter: Parameter, described: Any) -> None:
        reason = objection(parameter, described, declaring=True)
        if not reason:
            result = self._ask_callbacks([parameter])
            reason = "" if result.successful else result.reason or "refused"
        if reason:
            raise InvalidParameterValueException(parameter.name, parameter.value, reason)

    def declare_parameters(
        self, namespace: str, parameters: Iterable[Any], ignore_override: bool = False
    ) -> list[Parameter]:
        """Declare several parameters, given as (name), (name, value) or (name, value, descriptor)."""
        declared = []
        for entry in parameters:
            name, value, descriptor = (*((entry,) if isinstance(entry, str) else entry), None, None)[:3]
            full = f"{namespace}.{name}" if namespace else name
            declared.append(self.declare_parameter(full, value, descriptor, ignore_override))
        return declared

    def undeclare_parameter(self, name: str) -> None:
        """Undeclare a parameter.

        Raise ParameterNotDeclaredException, and ParameterImmutableException if it is read-only.
        """
        if name not in self._parameters:
            raise ParameterNotDeclaredException(name)
        if self.describe_parameter(name).read_only:
            raise ParameterImmutableException(name)
        del self._parameters[name]
        self._descriptors.pop(name, None)

    def has_parameter(self, name: str) -> bool:
        """Return whether a parameter is declared."""
        return name in self._parameters

    def get_parameter(self, name: str) -> Parameter:
        """Return a parameter. Raise ParameterNotDeclaredException."""
        parameter = self._parameters.get(name)
        if parameter is None:
            if self._allow_undeclared:
                return _without_value(name)
            raise ParameterNotDeclaredException(name)
        if parameter.value is None and not self.describe_parameter(name).dynamic_typing:
            raise ParameterUninitializedException(name)
        return parameter if parameter.value is not None else _without_value(name)

    def get_parameters(self, names: list[str]) -> list[Parameter]:
        """Return several parameters."""
        return [self.get_parameter(name) for name in names]

    def get_parameter_or(self, name: str, alternative_value: Parameter | None = None) -> Parameter:
        """Return a parameter; if it is not declared or has no value, return the alternative."""
        parameter = self._parameters.get(name)
        if parameter is None or parameter.value is None:
            return alternative_value if alternative_value is not None else _without_value(name)
        return parameter

    def get_parameters_by_prefix(self, prefix: str) -> dict[str, Parameter]:
        """Return the parameters below a prefix, by the rest of their names."""
        start = f"{prefix}." if prefix else ""
        return {name[len(start) :]: p for name, p in self._parameters.items() if name.startswith(start)}

    def get_parameter_type(self, name: str) -> ParameterType:
        """Return the type of a parameter."""
        return self.get_parameter(name).type_

    def get_parameter_types(self, names: list[str]) -> list[ParameterType]:
        """Return the types of several parameters."""
        return [self.get_parameter_type(name) for name in names]

    def list_parameters(self, prefixes: list[str], depth: int = 0) -> Any:
        """Return names as rcl_interfaces/ListParametersResult; a `depth` of 0 is unlimited."""
        made: Any = find_class("ros2", "rcl_interfaces", "ListParametersResult")
        names = [name for name in self._parameters if _below(name, prefixes, depth)]
        parents = {name.rpartition(".")[0] for name in names if "." in name}
        return made(names=sorted(names), prefixes=sorted(parents))

    def describe_parameter(self, name: str) -> Any:
        """Return a parameter's descriptor. Raise ParameterNotDeclaredException."""
        if name not in self._parameters:
            if self._allow_undeclared:
                return new_descriptor(name=name)
            raise ParameterNotDeclaredException(name)
        if name not in self._descriptors:
            self._descriptors[name] = new_descriptor(name=name, type=int(self._parameters[name].type_))
        return self._descriptors[name]

    def describe_parameters(self, names: list[str]) -> list[Any]:
        """Return several descriptors."""
        return [self.describe_parameter(name) for name in names]

    def set_descriptor(self, name: str, descriptor: Any, alternative_value: Any = None) -> Any:
        """Replace a descriptor; return the parameter's value. Raise if the value does not fit."""
        if self.describe_parameter(name).read_only:
            raise ParameterImmutableException(name)
        described = deepcopy(descriptor)
        described.name = name
        parameter = Parameter(name, value=alternative_value) if alternative_value is not None else None
        parameter = parameter or self._parameters[name]
        if not described.dynamic_typing:
            described.type = int(parameter.type_)
        reason = objection(parameter, described, declaring=True)
        if reason:
            raise InvalidParameterValueException(name, parameter.value, reason)
        self._parameters[name], self._descriptors[name] = parameter, described
        return parameter.get_parameter_value()

    def set_parameters(self, parameter_list: list[Parameter]) -> list[Any]:
        """Set parameters one by one; each result says whether the value was accepted."""
        self._require_declared(parameter_list)
        return [self._set([parameter]) for parameter in parameter_list]

    def set_parameters_atomically(self, parameter_list: list[Parameter]) -> Any:
        """Set all parameters or none."""
        self._require_declared(parameter_list)
        return self._set(list(parameter_list))

    def add_pre_set_parameters_callback(self, callback: SetCallback) -> None:
        """Register a callback that replaces the list of parameters before they are set."""
        self._pre_set_callbacks.insert(0, callback)

    def remove_pre_set_parameters_callback(self, callback: SetCallback) -> None:
        """Remove a callback."""
        self._pre_set_callbacks.remove(callback)

    def add_on_set_parameters_callback(self, callback: SetCallback) -> None:
        """Register a callback that can reject a change; the newest is called first."""
        self._set_callbacks.insert(0, callback)

    def remove_on_set_parameters_callback(self, callback: SetCallback) -> None:
        """Remove a callback."""
        self._set_callbacks.remove(callback)

    def add_post_set_parameters_callback(self, callback: SetCallback) -> None:
        """Register a callback that is called after parameters changed."""
        self._post_set_callbacks.insert(0, callback)

    def remove_post_set_parameters_callback(self, callback: SetCallback) -> None:
        """Remove a callback."""
        self._post_set_callbacks.remove(callback)

    def _require_declared(self, parameters: list[Parameter]) -> None:
        if not self._allow_undeclared:
            unknown = [p.name for p in parameters if p.name not in self._parameters]
            if unknown:
                raise ParameterNotDeclaredException(unknown)

    def _set(self, parameters: list[Parameter]) -> Any:
        for rewrite in tuple(self._pre_set_callbacks):
            parameters = rewrite(parameters)
        for parameter in parameters:
            if parameter.name in self._parameters:
                described = self.describe_parameter(parameter.name)
                reason = objection(parameter, described, declaring=False)
                if reason:
                    return outcome(False, reason)
        result = self._ask_callbacks(parameters)
        if result.successful:
            self._store(parameters)
            for callback in tuple(self._post_set_callbacks):
                callback(parameters)
        return result

    def _store(self, parameters: list[Parameter]) -> None:
        changed = {p.name for p in parameters} & set(self._parameters)
        for parameter in parameters:
            if parameter.type_ == ParameterType.NOT_SET:
                self._parameters.pop(parameter.name, None)
                self._descriptors.pop(parameter.name, None)
                continue
            if parameter.name not in self._parameters:
                self._descriptors[parameter.name] = new_descriptor(name=parameter.name, dynamic_typing=True)
            self._parameters[parameter.name] = parameter
        self.parameters_changed(parameters, changed)

    def parameters_changed(self, parameters: list[Parameter], known: set[str]) -> None:
        """Announce changed parameters; `known` are the names declared before."""

    def _ask_callbacks(self, parameters: list[Parameter]) -> Any:
        for callback in tuple(self._set_callbacks):
            result = callback(parameters)
            if not hasattr(result, "successful"):
                return outcome(False, "Callback returned an invalid type")
            if not result.successful:
                return result
        return outcome(True)


def _without_value(name: str) -> Parameter:
    """Return a parameter without a value; note for error messages that the node asked for it."""
    process = running_process()
    if process is not None:
        process.unset[name] = None
    return Parameter(name)


def _below(name: str, prefixes: list[str], depth: int) -> bool:
    for prefix in prefixes or [""]:
        if name == prefix:
            return True
        if not prefix or name.startswith(prefix + "."):
            rest = name[len(prefix) + 1 :] if prefix else name
            if not depth or rest.count(".") < depth:
                return True
    return False
