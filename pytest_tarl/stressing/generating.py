"""Generate drifts with Hypothesis, steered towards low margins by `target`."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from pytest_tarl.spaces import Choice, Point, Space, Span, nominal

BITS = 4  # number of bits drawn for the size of a change


def generate(space: Space, seed: int, tries: int, margin: Callable[[Point], float | None]) -> None:
    """Call `margin` with up to `tries` generated drifts, until it returns None. Re-raise what `margin` raises.

    Only booleans are drawn: for numbers, Hypothesis mixes in constants from imported modules, and these differ between
    worker processes. Its database is disabled because it also makes runs differ.
    """
    import hypothesis
    from hypothesis import strategies as st

    ended = False
    raised: Exception | None = None
    parts = st.tuples(*(st.tuples(*[st.booleans()] * (BITS + 2)) for _ in space.extents))

    @hypothesis.seed(seed)
    @hypothesis.settings(
        database=None,
        deadline=None,
        max_examples=tries,
        phases=(hypothesis.Phase.generate, hypothesis.Phase.target),
        suppress_health_check=list(hypothesis.HealthCheck),
    )
    @hypothesis.given(parts)
    def run(drawn: tuple[tuple[bool, ...], ...]) -> None:
        nonlocal ended, raised
        try:
            found = None if ended else margin(_point(space, drawn))
        # Hypothesis would run the drift again if it saw the error
        except Exception as problem:
            found, raised = None, problem
        if found is None:
            ended = True
        else:
            hypothesis.target(-found, label="margin")

    run()
    if raised is not None:
        raise raised


def _point(space: Space, drawn: tuple[tuple[bool, ...], ...]) -> Point:
    """Return the point for drawn bits, which give for each direction whether it changes, to which side, and how far."""
    found: dict[str, float] = {}
    for (name, extent), (part, side, *bits) in zip(space.extents.items(), drawn, strict=True):
        number = sum(bit << place for place, bit in enumerate(bits))
        found[name] = _number(extent, side, number) if part else nominal(extent)
    return found


def _number(extent: Span | Choice, side: bool, number: int) -> Any:
    if isinstance(extent, Choice):
        return float(number % len(extent.options))
    usual = nominal(extent)
    end = extent.high if (side or usual == extent.low) and usual != extent.high else extent.low
    return usual + (end - usual) * (number + 1) / 2**BITS
