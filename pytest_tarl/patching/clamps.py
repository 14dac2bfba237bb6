"""Names of functions that limit a value to a range."""

from __future__ import annotations

from typing import Final

# the argument of `max` is a lower limit, that of `min` an upper limit
OPPOSITE: Final = {"max": "min", "min": "max"}
# functions called as f(x, low, high)
CLAMPS: Final = frozenset(["bound", "clamp", "clip", "constrain", "saturate"])
BOUNDING: Final = CLAMPS | OPPOSITE.keys()  # functions with a limit among their arguments
