"""Names of functions that limit a value to a range."""

from __future__ import annotations

from typing import Final

OPPOSITE: Final = {"max": "min", "min": "max"}  # `max` has a lower limit as an argument, `min` an upper one
CLAMPS: Final = frozenset(["bound", "clamp", "clip", "constrain", "saturate"])  # called as f(x, low, high)
BOUNDING: Final = CLAMPS | OPPOSITE.keys()  # functions with a limit among their arguments
