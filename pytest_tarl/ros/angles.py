"""The ROS package angles: arithmetic with angles in radians."""

from __future__ import annotations

import math

__all__ = ["normalize_angle", "normalize_angle_positive", "shortest_angular_distance", "two_pi_complement"]

_TURN = 2 * math.pi


def normalize_angle_positive(angle: float) -> float:
    """Return the angle, normalized to the range from 0 to 2π."""
    return angle % _TURN


def normalize_angle(angle: float) -> float:
    """Return the angle, normalized to the range from −π to π."""
    positive = angle % _TURN
    return positive - _TURN if positive > math.pi else positive


def shortest_angular_distance(from_angle: float, to_angle: float) -> float:
    """Return the shortest rotation from one angle to the other, between −π and π."""
    return normalize_angle(to_angle - from_angle)


def two_pi_complement(angle: float) -> float:
    """Return the rotation that leads to the same orientation in the opposite direction."""
    within = math.fmod(angle, _TURN) if abs(angle) > _TURN else angle
    return _TURN - abs(within) if within < 0 else abs(within) - _TURN if within > 0 else _TURN
