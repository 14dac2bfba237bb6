"""Check that numbers from users are finite and not booleans."""

from __future__ import annotations

from math import isfinite
from typing import Any

from pytest_tarl.sensors import as_number


def finite_number(value: Any) -> float | None:
    """Return a finite real number or numpy scalar as a float; None for anything else, including booleans."""
    dtype = getattr(value, "dtype", None)
    if isinstance(value, bool) or getattr(dtype, "kind", "") == "b":
        return None
    number = as_number(value)
    return number if number is not None and isfinite(number) else None
