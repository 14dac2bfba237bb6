"""Words in names such as `wind_angle`, `FluidPressure` and `SIGN_LEFT`."""

from __future__ import annotations

import re
from typing import Final

_WORD: Final = re.compile(r"[A-Z]+(?![a-z])|[A-Z]?[a-z]+")


def words(text: str) -> set[str]:
    """Return the words of a text and of the names in it, in lower case and without digits."""
    return {word.lower() for word in _WORD.findall(text)}
