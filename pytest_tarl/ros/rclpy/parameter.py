"""Parameters of rclpy nodes."""

from __future__ import annotations

from array import array
from enum import IntEnum
from typing import Any

from pytest_tarl.ros import params_files
from pytest_tarl.ros.command_line_values import parse_value
from pytest_tarl.ros.messages import find_class

_FIELDS = {
    1: "bool_value", 2: "integer_value", 3: "double_value", 4: "string_value", 5: "byte_array_value",
    6: "bool_array_value", 7: "integer_array_value", 8: "double_array_value", 9: "string_array_value",
}  # fmt: skip


def parameter_dict_from_yaml_file(
    parameter_file: str,
    use_wildcard: bool = False,
    target_nodes: list[str] | None = None,
    namespace: str = "",
) -> dict[str, Any]:
    """Return rcl_interfaces/Parameter messages by name from a YAML file, for all nodes or for `target_nodes`.

    `use_wildcard` adds the parameters under `/**`. Raise RuntimeError if the file, or a node in it, is missing.
    """
    content = params_files.read(parameter_file)
    wanted = [f"/{name.strip('/')}" for name in target_nodes or ()]
    found: dict[str, Any] = {}
    keys = {f"/{str(key).strip('/')}": key for key in content}
    if use_wildcard and "/**" in keys:
        found.update(_named_values(content["/**"], namespace))
    missing = sorted(set(wanted) - keys.keys())
    if missing:
        raise RuntimeError(
            f"Param file does not contain any parameters for {missing},only for nodes: {sorted(keys)}"
        )
    for name, key in keys.items():
        if name != "/**" and (not wanted or name in wanted):
            found.update(_named_values(content[key], namespace))
    if not found:
        raise RuntimeError("Param file does not contain any parameters")
    return {name: Parameter(name, value=value).to_parameter_msg() for name, value in found.items()}


def _named_values(section: Any, above: str) -> dict[str, Any]:
    """Return the values in a node's section by dotted name. Raise RuntimeError for an invalid file."""
    found: dict[str, Any] = {}
    if not isinstance(section, dict) or "ros__parameters" not in section:
        raise RuntimeError("YAML file is not a valid ROS parameter file")
    pending = [(above, section["ros__parameters"])]
    while pending:
        prefix, values = pending.pop(0)
        for key, value in values.items():
            name = f"{prefix}.{key}" if prefix else str(key)
            if isinstance(value, dict):
                pending.append((name, value))
            else:
                found[name] = value
    return found


class ParameterType(IntEnum):
    """The types of parameters, with the numbers of rcl_interfaces/ParameterType."""

    def __str__(self) -> str:
        return str(int(self))

    def __format__(self, form: str) -> str:
        return format(int(self), form)

    NOT_SET = 0
    BOOL = 1
    INTEGER = 2
    DOUBLE = 3
    STRING = 4
    BYTE_ARRAY = 5
    BOOL_ARRAY = 6
    INTEGER_ARRAY = 7
    DOUBLE_ARRAY = 8
    STRING_ARRAY = 9

    @classmethod
    def from_parameter_value(cls, parameter_value: Any) -> ParameterType:
        """Return the type of a Python value. Raise TypeError if no parameter type fits."""
        return type_of(parameter_value)


def type_of(value: Any) -> ParameterType:
    """Return the parameter type of a Python value. Raise TypeError if no parameter type fits."""
    if value is None:
        return ParameterType.NOT_SET
    for python_type, plain in _PLAIN:
        if isinstance(value, python_type):
            return plain
    if isinstance(value, list | tuple | array):
        kinds = {type_of(element) for element in value}
        if not kinds:
            return ParameterType.BYTE_ARRAY
        if len(kinds) == 1 and (found := _ARRAYS.get(kinds.pop())) is not None:
            return found
    raise TypeError(f"The given value is not one of the allowed types '{value}'.")


_PLAIN = (
    (bool, ParameterType.BOOL),
    (int, ParameterType.INTEGER),
    (float, ParameterType.DOUBLE),
    (str, ParameterType.STRING),
)
_ARRAYS = {
    ParameterType.BOOL: ParameterType.BOOL_ARRAY,
    ParameterType.INTEGER: ParameterType.INTEGER_ARRAY,
    ParameterType.DOUBLE: ParameterType.DOUBLE_ARRAY,
    ParameterType.STRING: ParameterType.STRING_ARRAY,
}


class Parameter:
    """A named, immutable value."""

    Type = ParameterType

    def __init__(self, name: str, type_: ParameterType | None = None, value: Any = None) -> None:
        found = type_of(value)
        if type_ is not None and value is not None and type_ != found:
            # type_of takes an empty list for a BYTE_ARRAY, but it fits every array type
            if not (found == ParameterType.BYTE_ARRAY and not value):
                raise ValueError(f"Type '{type_}' and value '{value}' do not agree")
            found = type_
        self.name = name
        self.type_ = found if type_ is None or value is not None else type_
        self.value = value

    @property
    def type(self) -> ParameterType:
        """Return the parameter's type."""
        return self.type_

    def get_parameter_value(self) -> Any:
        """Convert to rcl_interfaces/ParameterValue."""
        made: Any = find_class("ros2", "rcl_interfaces", "ParameterValue")
        if self.value is None:
            return made(type=int(ParameterType.NOT_SET))
        return made(type=int(self.type_), **{_FIELDS[int(self.type_)]: self.value})

    def to_parameter_msg(self) -> Any:
        """Convert to rcl_interfaces/Parameter."""
        made: Any = find_class("ros2", "rcl_interfaces", "Parameter")
        return made(name=self.name, value=self.get_parameter_value())

    @classmethod
    def from_parameter_msg(cls, param_msg: Any) -> Parameter:
        """Create a parameter from rcl_interfaces/Parameter."""
        return cls(param_msg.name, value=parameter_value_to_python(param_msg.value))

    def __repr__(self) -> str:
        return f"Parameter(name={self.name!r}, type={self.type_.name}, value={self.value!r})"


def get_parameter_value(string_value: str) -> Any:
    """Return rcl_interfaces/ParameterValue for a YAML value; text that is not YAML becomes a string."""
    return Parameter("value", value=parse_value(string_value)).get_parameter_value()


def parameter_value_to_python(parameter_value: Any) -> Any:
    """Return the Python value of rcl_interfaces/ParameterValue."""
    field = _FIELDS.get(parameter_value.type)
    value: Any = getattr(parameter_value, field) if field is not None else None
    return value.tolist() if hasattr(value, "tolist") else value


PARAMETER_SEPARATOR_STRING = "."
