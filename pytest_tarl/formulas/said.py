"""Formulas and signals found in a test's source, outside its marker."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Said:
    """Literal names in calls of `tarl.observe`, and literal texts in calls of `tarl.require`.

    `computed` tells whether some observed name is computed, `requires` whether the test calls tarl.require.
    """

    observed: tuple[str, ...] = ()
    texts: tuple[str, ...] = ()
    computed: bool = False
    requires: bool = False


NOTHING_SAID = Said()
