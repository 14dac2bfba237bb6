"""Find the formulas and signals in a test's source outside its marker."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Said:
    """The literal names in calls of `tarl.observe`, and the literal strings in calls of `tarl.require`.

    `computed` says whether some call of `tarl.observe` computes the name; `requires` says whether the test calls
    `tarl.require`.
    """

    observed: tuple[str, ...] = ()
    texts: tuple[str, ...] = ()
    computed: bool = False
    requires: bool = False


NOTHING_SAID = Said()
