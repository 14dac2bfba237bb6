"""Random small nodes with exceptions, loops, containers, objects and deletions, for the tests that execute them."""

from __future__ import annotations

import random
from collections.abc import Callable
from textwrap import indent
from typing import Final

from tests.lint.executed.wiring import CLASSES, wiring

HEAD: Final = """\
import rospy
from std_msgs.msg import Float64


class Fault(Exception):
    pass


class Worse(Fault):
    pass


class Missing(Fault, KeyError):
    pass


class Box:
    y = 0

    def __init__(self, x=0):
        self.x = x
        self.kept = []

    def put(self, x):
        self.x = x
        return x

    def take(self):
        if self.kept:
            return self.kept.pop()
        raise IndexError("empty")


def make(x):
    return Box(x)


def checked(x):
    if x > 1:
        raise ERROR(x)
    return x


"""
START: Final = """\
    def __init__(self):
        self.n, self.m = 0, 1
        self.l = [0, 1]
        self.k = []
        self.d = {"a": 0, "b": 1}
        self.s = {0, 1}
        self.b, self.c = Box(), Box(1)
        self.boxes = [Box() for _ in range(2)]
"""
RAISED: Final = (
    "ValueError", "KeyError", "IndexError", "ZeroDivisionError", "OSError", "NotImplementedError", "UnicodeError",
    "Fault", "Worse", "Missing",
)  # fmt: skip
CAUGHT: Final = (
    *RAISED, "LookupError", "ArithmeticError", "RuntimeError", "Exception", "(KeyError, ValueError)",
    "(Fault, OSError)",
)  # fmt: skip
NUMBERS: Final = ("n", "n", "n", "m", "self.n", "self.n", "self.m")
LISTS: Final = ("self.l", "self.k", "p")
BOXES: Final = ("self.b", "self.c", "t", "self.boxes[0]", "self.boxes[1]", "self.boxes[-1]")
CONSTANTS: Final = ("0", "1", "2", "3")
KEYS: Final = ('"a"', '"b"', '"c"')


class Generator:
    """Draws one program; the same seed gives the same program."""

    def __init__(self, seed: int) -> None:
        self.seed = seed
        self.draw = random.Random(seed)
        self.outputs = 0
        self.helpers = False
        self.families = self.draw.sample(("list", "dict", "set", "box"), self.draw.choice([1, 1, 2]))
        self.lists = tuple(self.draw.sample(LISTS, self.draw.choice([1, 2])))
        self.boxes = tuple(self.draw.sample(BOXES, self.draw.choice([1, 2, 3])))
        self.keys = tuple(self.draw.sample(KEYS, self.draw.choice([1, 2])))

    def program(self) -> str:
        """Return the text of a node with two subscriptions, a timer and several publish calls."""
        methods = [
            self.method("on_a", "msg", "msg.data"),
            self.method("on_b", "msg", "msg.data"),
            self.method("tick", "event", "0"),
        ]
        helper = self.method("helper", "n", "n") + f"        return {self.number(1)}\n"
        ends = "".join(f"        {line}\n" for line in wiring(self.seed, self.outputs))
        head = HEAD.replace("ERROR", self.draw.choice(RAISED)) + CLASSES
        body = "\n".join([START + ends, helper, *methods])
        return (
            f'{head}class Node(Listener):\n{body}\n\nrospy.init_node("node")\nnode = Node()\nrospy.spin()\n'
        )

    def method(self, name: str, parameter: str, first: str) -> str:
        """Return a method; its local variables are two numbers, a list and a box."""
        self.helpers = name != "helper"  # helpers do not call themselves
        opening = [
            f"n, m = {first}, {self.one(CONSTANTS)}",
            f"p = {self.draw.choice(['[]', '[n]', 'list(self.l)', 'self.k'])}",
            f"t = {self.draw.choice(['self.b', 'self.c', 'make(0)', 'self.boxes[0]', 'Box(n)'])}",
        ]
        body = self.block(2, 0, self.draw.randint(1, 4))
        if name != "helper":
            body += self.publish()
        mark = [f'@marked("{name[-1]}")'] if name.startswith("on_") else []
        lines = [*mark, f"def {name}(self, {parameter}):", *(f"    {line}" for line in [*opening, *body])]
        return indent("\n".join(lines) + "\n", "    ")

    # --- statements ---------------------------------------------------------------------------------------

    def block(self, depth: int, loops: int, size: int = 0) -> list[str]:
        """Return the lines of one or more statements; `loops` is the number of loops around."""
        lines: list[str] = []
        for _ in range(size or self.draw.randint(1, 2)):
            compound = depth > 0 and self.draw.random() < 0.45
            lines += self.compound(depth - 1, loops) if compound else self.simple(loops)
        return lines

    def simple(self, loops: int) -> list[str]:
        """Return a statement without a body, or one behind a condition that keeps it from failing."""
        changes = {
            "list": self.change_list,
            "dict": self.change_dict,
            "set": self.change_set,
            "box": self.change_box,
        }
        change = changes[self.draw.choice(self.families)]
        kinds: list[Callable[[], list[str]]] = [
            self.assignment,
            self.assignment,
            change,
            change,
            change,
            self.publish,
            self.leave,
        ]
        if loops:
            kinds.append(lambda: [f"if {self.condition()}:", f"    {self.one(('break', 'continue'))}"])
        return self.draw.choice(kinds)()

    def compound(self, depth: int, loops: int) -> list[str]:
        """Return a statement with a body."""
        kind = self.draw.choice(["if", "if", "for", "while", "try", "try", "try"])
        body = self.nested(depth, loops + (kind in ("for", "while")))
        if kind == "if":
            lines = [f"if {self.condition()}:", *body]
            return lines if self.draw.random() < 0.6 else [*lines, "else:", *self.nested(depth, loops)]
        if kind == "for":
            source = self.draw.choice(
                ["range(2)", "(1, 2)", f"list({self.one(self.lists)})[:3]", "sorted(self.s)[:3]"]
            )
            variable = self.draw.choice(["m", "m", "i"])
            return [f"for {variable} in {source}:", *body]
        if kind == "while":
            name = f"w{depth}{loops}"
            return [f"{name} = 0", f"while {name} < 3 and {self.condition()}:", f"    {name} += 1", *body]
        return self.attempt(depth, loops, body)

    def attempt(self, depth: int, loops: int, body: list[str]) -> list[str]:
        """Return a `try`, most often with a statement that can fail."""
        failing = self.draw.choice([self.fail, self.fail, self.look_up, list])()
        lines = ["try:", *(f"    {line}" for line in failing), *body]
        if self.draw.random() < 0.15:
            return [*lines, "finally:", *self.nested(0, loops)]
        for _ in range(self.draw.choice([1, 1, 2])):
            caught = self.one(CAUGHT)
            if self.draw.random() < 0.3:
                lines += [
                    f"except {caught} as error:",
                    "    n = len(error.args)",
                    *self.nested(depth, loops),
                ]
            else:
                lines += [f"except {caught}:", *self.nested(depth, loops)]
        if self.draw.random() < 0.25:
            lines += ["else:", *self.nested(0, loops)]
        if self.draw.random() < 0.15:
            lines += ["finally:", *self.nested(0, loops)]
        return lines

    def nested(self, depth: int, loops: int) -> list[str]:
        return [f"    {line}" for line in self.block(depth, loops)]

    def fail(self) -> list[str]:
        """Return a statement that raises on some condition."""
        name = self.one(NUMBERS)
        calls = [f"{name} = checked({self.number(1)})"]
        if self.helpers:
            calls.append(f"{name} = self.helper({self.number(1)})")
        raising = [f"if {self.condition()}:", f"    raise {self.one(RAISED)}({self.number(1)})"]
        return self.draw.choice([raising, raising, [self.draw.choice(calls)]])

    def look_up(self) -> list[str]:
        """Return a statement that raises if an element is missing; the `try` around may not handle this."""
        number, name, key, box = (
            self.one(NUMBERS),
            self.one(self.lists),
            self.one(self.keys),
            self.one(self.boxes),
        )
        failing = {
            "list": [
                f"{number} = {name}.pop()",
                f"{number} = {name}[0]",
                f"{name}.remove({self.one(CONSTANTS)})",
            ],
            "dict": [f"{number} = self.d[{key}]", f"del self.d[{key}]", f"{number} = self.d.pop({key})"],
            "set": [f"self.s.remove({self.one(CONSTANTS)})", "self.s.pop()"],
            "box": [f"{number} = {box}.take()"],
        }
        return [self.draw.choice(failing[self.draw.choice(self.families)])]

    def leave(self) -> list[str]:
        ways = ["return 0", *self.fail()[-1:]]
        way = self.draw.choice(ways).strip()
        return [f"if {self.condition()}:", f"    {way}"]

    def assignment(self) -> list[str]:
        return [f"{self.one(NUMBERS)} {self.draw.choice(['=', '=', '+='])} {self.number(2)}"]

    def publish(self) -> list[str]:
        self.outputs += 1
        whole = {
            "list": f"list({self.one(self.lists)})",
            "dict": "sorted(self.d.items())",
            "set": "sorted(self.s)",
        }
        family = self.draw.choice(self.families)
        given = whole[family] if family in whole and self.draw.random() < 0.3 else self.number(2)
        return [f"self.out{self.outputs - 1}.publish({given})"]

    def change_list(self) -> list[str]:
        name, number = self.one(self.lists), self.number(1)
        return self.draw.choice([
            [f"{name}.append({number})"],
            [f"{name}.insert(0, {number})"],
            [f"{name}.extend([{number}, 1])"],
            [f"{name}.clear()"],
            [f"{name}.sort()"],
            [f"{name}.reverse()"],
            [f"{name} += [{number}]"],
            [f"{name} = [{number}]"],
            [f"{name} = {name}[1:]"],
            [f"{name} = [q + 1 for q in {self.one(self.lists)}][:4]"],
            [f"if {name}:", f"    {name}.pop()"],
            [f"if {name}:", f"    {self.one(NUMBERS)} = {name}.pop(0)"],
            [f"if {name}:", f"    del {name}[0]"],
            [f"if {name}:", f"    {name}[0] = {number}"],
            [f"if 1 in {name}:", f"    {name}.remove(1)"],
            [f"del {name}[1:]"],
            [f"{name}[:] = [{number}]"],
        ])  # fmt: skip

    def change_dict(self) -> list[str]:
        key, number = self.one(self.keys), self.number(1)
        return self.draw.choice([
            [f"self.d[{key}] = {number}"],
            [f"self.d.pop({key}, None)"],
            [f"{self.one(NUMBERS)} = self.d.pop({key}, 0)"],
            [f"if {key} in self.d:", f"    del self.d[{key}]"],
            ["self.d.clear()"],
            [f"self.d.update({{{key}: {number}}})"],
            [f"self.d.setdefault({key}, {number})"],
            [f"self.d = {{{key}: {number}}}"],
            ["if self.d:", "    self.d.popitem()"],
            ["for key, value in sorted(self.d.items()):", f"    {self.one(NUMBERS)} = value"],
            ["for key in sorted(self.d):", f"    self.d[key] = {number}"],
        ])  # fmt: skip

    def change_set(self) -> list[str]:
        return self.draw.choice([
            [f"self.s.add({self.number(1)})"],
            [f"self.s.discard({self.one(CONSTANTS)})"],
            ["self.s.clear()"],
            [f"self.s = {{{self.number(1)}}}"],
            [f"self.s |= {{{self.one(CONSTANTS)}}}"],
            ["if 1 in self.s:", "    self.s.remove(1)"],
        ])  # fmt: skip

    def change_box(self) -> list[str]:
        box, number = self.one(self.boxes), self.number(1)
        return self.draw.choice([
            [f"{box}.x = {number}"],
            [f"{box}.put({number})"],
            [f"{box}.y = {number}"],
            [f"{box}.kept.append({number})"],
            [f'if "y" in vars({box}):', f"    del {box}.y"],
            [f"self.b = {self.draw.choice(['t', 'Box()', 'make(0)', 'self.c'])}"],
            [f"t = {box}"],
            ["t = make(0)"],
            [f"t = make({number})"],
            [f"self.boxes.insert(0, Box({number}))"],
            ["self.boxes.reverse()"],
            ["if len(self.boxes) > 2:", "    self.boxes.pop()"],
            [f"self.boxes = [make(q) for q in (0, {number})]"],
            ["for q in self.boxes:", f"    q.x {self.draw.choice(['=', '+='])} {number}"],
            ["for q in (self.b, t):", f"    q.x {self.draw.choice(['=', '+='])} {number}"],
            ["for i, q in enumerate(self.boxes):", f"    q.x = {self.draw.choice(['i', number])}"],
            [f"self.boxes[0] = {self.draw.choice(['self.boxes[1]', 't', 'Box()'])}"],
        ])  # fmt: skip

    # --- expressions --------------------------------------------------------------------------------------

    def number(self, depth: int) -> str:
        """Return an expression for a number."""
        if depth <= 0 or self.draw.random() < 0.35:
            return self.one(CONSTANTS) if self.draw.random() < 0.4 else self.one(NUMBERS)
        if self.draw.random() < 0.3:
            first, second, test = self.number(depth - 1), self.number(depth - 1), self.condition(depth - 1)
            return self.draw.choice([f"({first} + {second}) % 5", f"({first} if {test} else {second})"])
        name, box, key = self.one(self.lists), self.one(self.boxes), self.one(self.keys)
        readings = {
            "list": [
                f"({name}[0] if {name} else 0)", f"({name}[-1] if {name} else 0)", f"sum({name})", f"len({name})",
                f"max({name}, default=0)",
            ],
            "dict": [
                f"self.d.get({key}, 0)", f"(self.d[{key}] if {key} in self.d else 2)", "len(self.d)",
                "sum(self.d.values())",
            ],
            "set": ["len(self.s)", "max(self.s, default=0)", "sum(self.s)"],
            "box": [
                f"{box}.x", f"{box}.x", f"{box}.x", f"{box}.y", f"len({box}.kept)", "len(self.boxes)",
                "sum(q.x for q in self.boxes)",
            ],
        }  # fmt: skip
        return self.draw.choice(readings[self.draw.choice(self.families)])

    def condition(self, depth: int = 1) -> str:
        """Return a condition."""
        name, number, constant = self.one(self.lists), self.number(min(depth, 1)), self.one(CONSTANTS)
        tests = {
            "list": [name, f"not {name}", f"{constant} in {name}"],
            "dict": [f"{self.one(self.keys)} in self.d", "self.d"],
            "set": [f"{constant} in self.s", "not self.s"],
            "box": [f"{self.one(self.boxes)} is {self.one(self.boxes)}", f"{self.one(self.boxes)}.kept"],
        }
        comparison = [
            f"{self.one(NUMBERS)} > {constant}",
            f"{number} > {constant}",
            f"{number} == {constant}",
        ]
        return self.draw.choice([*comparison, self.draw.choice(tests[self.draw.choice(self.families)])])

    def one(self, choices: tuple[str, ...]) -> str:
        """Draw one of several texts."""
        return self.draw.choice(choices)
