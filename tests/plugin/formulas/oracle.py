"""Signal temporal logic by its definition, over every instant of a grid: slow, and independent of rtamt."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

Tree = tuple  # ("always", (a, b) | None, child), ("until", …, left, right), ("<", name, number), …
BINARY = {"and", "or", "->", "<->", "xor"}
TINY = 1e-300


@dataclass(frozen=True)
class World:
    """Signals at the instants 0, 1, …, end; outside, they have the value at the nearest end."""

    signals: Mapping[str, Sequence[float]]
    end: int

    def at(self, name: str, time: int) -> float:
        return self.signals[name][min(max(time, 0), self.end)]


def value(tree: Tree, world: World) -> float:
    return over(tree, world)[0]


def over(tree: Tree, world: World) -> list[float]:
    """Return a formula's value at every instant, by the definition."""
    kind = tree[0]
    times = range(world.end + 1)
    if kind in ("<", "<=", ">", ">=", "==", "!="):
        return [compared(kind, world.at(tree[1], t), tree[2]) for t in times]
    if kind == "not":
        return [-one for one in over(tree[1], world)]
    if kind in BINARY:
        pairs = zip(over(tree[1], world), over(tree[2], world), strict=True)
        return [boolean(kind, a, b) for a, b in pairs]
    first, last = tree[1] if tree[1] is not None else (0, world.end)
    operands = [over(child, world) for child in tree[2:]]

    def held(which: int, t: int) -> float:
        return operands[which][min(max(t, 0), world.end)]

    if kind in ("always", "eventually"):
        pick = min if kind == "always" else max
        return [pick(held(0, s) for s in range(t + first, t + last + 1)) for t in times]
    if kind in ("historically", "once"):
        pick = min if kind == "historically" else max
        return [pick(held(0, s) for s in range(t - last, t - first + 1)) for t in times]
    if kind == "until":
        return [
            max(min([held(1, s), *(held(0, r) for r in range(t, s))]) for s in range(t + first, t + last + 1))
            for t in times
        ]
    if kind == "since":
        return [
            max(
                min([held(1, s), *(held(0, r) for r in range(s + 1, t + 1))])
                for s in range(t - last, t - first + 1)
            )
            for t in times
        ]
    raise AssertionError(kind)


def compared(kind: str, left: float, right: float) -> float:
    holds = {
        "<": left < right, "<=": left <= right, ">": left > right, ">=": left >= right, "==": left == right,
        "!=": left != right,
    }[kind]  # fmt: skip
    distance = abs(left - right) or TINY
    return distance if holds else -distance


def boolean(kind: str, a: float, b: float) -> float:
    return {
        "and": min(a, b),
        "or": max(a, b),
        "->": max(-a, b),
        "<->": min(max(-a, b), max(-b, a)),
        "xor": max(min(a, -b), min(-a, b)),
    }[kind]


def true(tree: Tree, world: World) -> list[bool]:
    """Return whether a formula holds, for every instant, without using robustness."""
    kind = tree[0]
    times = range(world.end + 1)
    if kind in ("<", "<=", ">", ">=", "==", "!="):
        return [compared(kind, world.at(tree[1], t), tree[2]) > 0 for t in times]
    if kind == "not":
        return [not one for one in true(tree[1], world)]
    if kind in BINARY:
        pairs = list(zip(true(tree[1], world), true(tree[2], world), strict=True))
        table = {
            "and": lambda a, b: a and b, "or": lambda a, b: a or b, "->": lambda a, b: not a or b,
            "<->": lambda a, b: a == b, "xor": lambda a, b: a != b,
        }  # fmt: skip
        return [table[kind](a, b) for a, b in pairs]
    first, last = tree[1] if tree[1] is not None else (0, world.end)
    operands = [true(child, world) for child in tree[2:]]

    def held(which: int, t: int) -> bool:
        return operands[which][min(max(t, 0), world.end)]

    if kind in ("always", "eventually"):
        pick = all if kind == "always" else any
        return [pick(held(0, s) for s in range(t + first, t + last + 1)) for t in times]
    if kind in ("historically", "once"):
        pick = all if kind == "historically" else any
        return [pick(held(0, s) for s in range(t - last, t - first + 1)) for t in times]
    if kind == "until":
        return [
            any(held(1, s) and all(held(0, r) for r in range(t, s)) for s in range(t + first, t + last + 1))
            for t in times
        ]
    return [
        any(
            held(1, s) and all(held(0, r) for r in range(s + 1, t + 1))
            for s in range(t - last, t - first + 1)
        )
        for t in times
    ]


def text(tree: Tree, unit: str, size: float = 1) -> str:
    """Return a formula in the user's syntax; bounds are numbers of instants, which are `size` units apart."""
    kind = tree[0]
    if kind in ("<", "<=", ">", ">=", "==", "!="):
        return f"({tree[1]} {kind} {tree[2]:g})"
    if kind == "not":
        return f"(not {text(tree[1], unit, size)})"
    if kind in BINARY:
        return f"({text(tree[1], unit, size)} {kind} {text(tree[2], unit, size)})"
    window = "" if tree[1] is None else f"[{tree[1][0] * size:g}{unit}:{tree[1][1] * size:g}{unit}]"
    if kind in ("until", "since"):
        return f"({text(tree[2], unit, size)} {kind}{window} {text(tree[3], unit, size)})"
    return f"({kind}{window} {text(tree[2], unit, size)})"
