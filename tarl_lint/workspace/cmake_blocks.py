"""The calls of a CMake text in the order of execution: `macro`, `function` and `foreach` are expanded."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from typing import Final, NamedTuple


class Call(NamedTuple):
    """A call: the name of the command in lower case, its arguments, and its line."""

    name: str
    words: Sequence[str]
    line: int = 0


Called = tuple[str, tuple[str, ...], int]  # a call with its variables replaced
Variables = dict[str, list[str]]
DEEPEST: Final = 8  # maximum nesting of macros and loops
MOST: Final = 10_000  # maximum number of calls of commands that are evaluated
_ENDS: Final = {"macro": "endmacro", "function": "endfunction", "foreach": "endforeach"}


@dataclass
class Blocks:
    """Expands blocks. The function `replaced` returns the words of a call with their variables replaced."""

    replaced: Callable[[Sequence[str], Variables], tuple[str, ...]]
    variables: Variables
    macros: dict[str, tuple[tuple[str, ...], list[Call]]] = field(default_factory=dict)
    left: int = MOST

    def run(self, calls: Sequence[Call], depth: int = 0) -> Iterator[Called]:
        """Yield the calls with variables replaced. The code that receives them may change variables in between."""
        place = 0
        while place < len(calls) and self.left > 0 and depth <= DEEPEST:
            name, words, line = calls[place]
            self.left -= 1
            end = _closing(calls, place) if name in _ENDS else place
            body = list(calls[place + 1 : end])
            given = self.replaced(words, self.variables)
            if name == "foreach":
                yield from self._loop(given, body, depth)
            elif name in _ENDS:
                self.macros[given[0].lower() if given else ""] = given[1:], body
            elif name in self.macros:
                yield from self._called(name, given, depth)
            else:
                yield name, given, line
            place = end + 1

    def _loop(self, words: Sequence[str], body: list[Call], depth: int) -> Iterator[Called]:
        for item in self._items(words[1:]):
            self.variables[words[0]] = [item]
            yield from self.run(body, depth + 1)

    def _items(self, words: Sequence[str]) -> list[str]:
        """Return the items of `foreach(x a b)` or `foreach(x IN LISTS names ITEMS a)`; empty for a range."""
        if words[:1] == ("RANGE",):
            return []
        if words[:1] != ("IN",):
            return list(words)
        found: list[str] = []
        kind = ""
        for word in words[1:]:
            if word in ("LISTS", "ITEMS"):
                kind = word
            else:
                found += self.variables.get(word, []) if kind == "LISTS" else [word]
        return found

    def _called(self, name: str, given: tuple[str, ...], depth: int) -> Iterator[Called]:
        names, body = self.macros[name]
        before = dict(self.variables)
        self.variables |= {one: [value] for one, value in zip(names, given, strict=False)}
        self.variables |= {"ARGN": list(given[len(names) :]), "ARGV": list(given)}
        yield from self.run(body, depth + 1)
        for one in (*names, "ARGN", "ARGV"):
            self.variables.pop(one, None)
            self.variables.update({one: before[one]} if one in before else {})


def _closing(calls: Sequence[Call], start: int) -> int:
    """Return the index of the call that ends the block at `start`; the last one if there is none."""
    name, depth = calls[start][0], 0
    for index in range(start, len(calls)):
        depth += {name: 1, _ENDS[name]: -1}.get(calls[index][0], 0)
        if not depth:
            return index
    return len(calls) - 1
