"""Names of functions that limit a value to a range."""

from __future__ import annotations

from typing import Final

# `max` takes a lower limit as an argument, `min` takes an upper limit
OPPOSITE: Final = {"max": "min", "min": "max"}
# functions that are called as f(x, low, high)
CLAMPS: Final = frozenset(["bound", "clamp", "clip", "constrain", "saturate"])
BOUNDING: Final = CLAMPS | OPPOSITE.keys()  # functions with a limit among their arguments
