"""Check parameter values against their descriptors: type, range, read-only."""

from __future__ import annotations

import math
from typing import Any

from pytest_tarl.ros.messages import find_class
from pytest_tarl.ros.rclpy.parameter import Parameter, ParameterType

_TOLERANCE = 1e-6


def new_descriptor(**fields: Any) -> Any:
    """Create rcl_interfaces/ParameterDescriptor."""
    made: Any = find_class("ros2", "rcl_interfaces", "ParameterDescriptor")
    return made(**fields)


def objection(parameter: Parameter, descriptor: Any, *, declaring: bool) -> str:
    """Return rclpy's reason for rejecting a value; empty if the descriptor allows it."""
    if descriptor.read_only and not declaring:
        return f"Trying to set a read-only parameter: {parameter.name}."
    if not descriptor.dynamic_typing:
        if parameter.type_ == ParameterType.NOT_SET and not declaring:
            return "Static parameter cannot be undeclared"
        if parameter.type_ != ParameterType.NOT_SET and not fits(parameter, descriptor.type):
            wanted = ParameterType(descriptor.type)
            return f"Wrong parameter type, expected 'Type.{wanted.name}' got 'Type.{parameter.type_.name}'"
    if parameter.type_ == ParameterType.INTEGER and descriptor.integer_range:
        return _outside_integers(parameter, descriptor.integer_range[0])
    if parameter.type_ == ParameterType.DOUBLE and descriptor.floating_point_range:
        return _outside_floats(parameter, descriptor.floating_point_range[0])
    return ""


def fits(parameter: Parameter, expected: int) -> bool:
    """Return whether a value has the declared type; an empty list fits every array type."""
    if expected == ParameterType.NOT_SET or parameter.type_ == expected:
        return True
    empty = isinstance(parameter.value, list | tuple) and not parameter.value
    return empty and ParameterType(expected).name.endswith("ARRAY")


def _outside_integers(parameter: Parameter, limits: Any) -> str:
    low, high = sorted((limits.from_value, limits.to_value))
    if parameter.value in (low, high):
        return ""
    if not low < parameter.value < high:
        return _out_of_range(parameter, low, high, " out of range.")
    if limits.step and (parameter.value - low) % limits.step:
        return _no_step(parameter, low, high, limits.step, "not a valid step")
    return ""


def _outside_floats(parameter: Parameter, limits: Any) -> str:
    low, high = sorted((limits.from_value, limits.to_value))
    if any(math.isclose(parameter.value, edge, rel_tol=_TOLERANCE) for edge in (low, high)):
        return ""
    if not low < parameter.value < high:
        return _out_of_range(parameter, low, high, " out of range")
    if limits.step:
        nearest = low + round((parameter.value - low) / limits.step) * limits.step
        if not math.isclose(nearest, parameter.value, rel_tol=_TOLERANCE):
            return _no_step(parameter, low, high, limits.step, "not close enough to a valid step")
    return ""


def _out_of_range(parameter: Parameter, low: Any, high: Any, said: str) -> str:
    return f"Parameter {parameter.name}{said} Min: {low}, Max: {high}, value: {parameter.value}"


def _no_step(parameter: Parameter, low: Any, high: Any, step: Any, said: str) -> str:
    return (
        f"The parameter value for {parameter.name} is {said}. "
        f"Min: {low}, max: {high}, value: {parameter.value}, step: {step}"
    )
