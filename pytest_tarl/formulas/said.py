"""Find formulas and signals in a test's source outside its marker."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Said:
    """The literal names in calls of `tarl.observe`, and the literal strings in calls of `tarl.require`.

    `computed` says whether the name in any call of `tarl.observe` is computed; `requires` says whether the test calls
    `tarl.require`.
    """

    observed: tuple[str, ...] = ()
    texts: tuple[str, ...] = ()
    computed: bool = False
    requires: bool = False


NOTHING_SAID = Said()
