"""Formulas and signals in a test's source, besides its marker."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Said:
    """Names that `tarl.observe` is called with, and the texts given to `tarl.require`, where they stand in the source.

    `computed` tells whether observed names are computed somewhere, `requires` whether tarl.require is called at all.
    """

    observed: tuple[str, ...] = ()
    texts: tuple[str, ...] = ()
    computed: bool = False
    requires: bool = False


NOTHING_SAID = Said()
