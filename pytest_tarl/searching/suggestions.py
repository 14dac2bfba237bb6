"""Suggestions: changes that a sweep gets from recorded missions, from the program's text and from another search."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

from pytest_tarl.searching.constants_first import Scaled
from pytest_tarl.searching.further_on import Entered
from pytest_tarl.searching.laws import Proportional
from pytest_tarl.searching.limits_in_turn import Reached
from pytest_tarl.searching.search import Candidate
from tarl_lint.model import Operand

Hint = tuple[tuple[Operand, float], ...]  # constants that change together, each with its factor


@dataclass(frozen=True)
class Suggestions:
    """Functions that a sweep calls for suggestions. By default, there are none.

    - `interlude` takes the largest gain so far and may yield candidates of another search. It is called before each
      step and each long phase.
    - `due` takes the largest gain so far. It returns whether `interlude` would now begin the structural changes.
    - `corrections` yields confirmed corrections of sensor readings. It is called before extreme changes.
    - `following` takes a candidate and yields candidates in which its constant follows a sensor or a variable.
    - `proportional` takes the uses of an unchanged constant and yields candidates in which it is proportional to a
      sensor or a variable (see `laws`).
    - `measured` takes the constants and returns the changes that recorded missions suggest.
    - `reached` takes a change and returns the limits that missions with this change reach only in the drifted world
      (see `limits_in_turn`).
    - `entered` takes a change and returns the constants of statements that run only with this change (see
      `further_on`).
    - `scaled` takes a change of the other search. If the change scales a command, it returns how (see
      `constants_first`).
    """

    interlude: Callable[[float], Iterator[Candidate]] = lambda _: iter(())
    due: Callable[[float], bool] = lambda _: False
    corrections: Callable[[], Iterator[Candidate]] = lambda: iter(())
    following: Callable[[Candidate], Iterator[Candidate]] = lambda _: iter(())
    proportional: Proportional = lambda _: iter(())
    measured: Callable[[Sequence[Operand]], Sequence[Hint]] = lambda _: ()
    reached: Reached = lambda _: ()
    entered: Entered = lambda _: ()
    scaled: Callable[[Candidate], Scaled | None] = lambda _: None


NO_SUGGESTIONS = Suggestions()
