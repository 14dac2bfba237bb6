"""Find code that registers something (an input, a publisher, a timer) or makes objects of the analysed files.

A loop over such code is unrolled, so that each iteration has its own topics, callbacks and objects. A loop over
code that adds states or behaviours to other ones is unrolled as well, and so is a loop whose element chooses the
publisher or names an attribute. Functions and classes are distinguished only by their names. Code that calls one
of two functions with the same name is assumed to call both, so some loops are unrolled without need.
"""

from __future__ import annotations

import ast
from collections.abc import Hashable, Iterable, Iterator, MutableMapping, Sequence, Set
from typing import Any, Literal

from tarl_lint.interpret.node_starts import MAKES, REGISTERING
from tarl_lint.ir import nodes as ir
from tarl_lint.trees import children, last_name, walk

ADDS_STATE = "add a state"  # stands for the method `add` of a state machine
ADDS_PART = frozenset([ADDS_STATE, "add_auto", "add_child", "add_children", "insert_child", "prepend_child"])
MACHINES = frozenset(["StateMachine", "Sequence", "Concurrence", "Container"])
STATE_KEYWORDS = frozenset(["transitions", "remapping"])
REGISTRATIONS = REGISTERING | MAKES | ADDS_PART
SENDING = frozenset(["publish"])
BY_NAME = frozenset(["getattr", "setattr"])  # functions whose second argument is the name of an attribute
CONSTRUCTORS = frozenset(["__init__", "__new__", "__post_init__"])
# endings of the names of base classes whose objects hold no data of their own
VALUES = ("Error", "Exception", "Enum", "NamedTuple")
FUNCTIONS = (ast.FunctionDef, ast.AsyncFunctionDef)
DECIDING = (ast.If, ast.IfExp, ast.Match, ast.While, ast.Try, ast.BoolOp)
Function = ast.FunctionDef | ast.AsyncFunctionDef


class Registrations:
    """Answers whether code registers something or makes objects. The files are searched at the first question."""

    def __init__(self, trees: Sequence[ast.Module], wrappers: Iterable[str]) -> None:
        self.trees = trees
        self.wanted = REGISTRATIONS.union(name.rpartition(".")[2] for name in wrappers)
        # name of a function or class → the code that runs when this function or class is called; None before the
        # first search
        self.bodies: dict[str, list[ast.AST]] | None = None
        self.called: dict[str, frozenset[str]] = {}  # name → names that its code calls
        # loop, comprehension or name → whether it registers or makes objects
        self.known: dict[Hashable, bool] = {}
        # loop or comprehension → whether it calls a variable of the loop
        self.calling: dict[Hashable, bool] = {}
        self.asking: dict[ir.Loop, bool] = {}  # cache of `asks`
        self.naming: dict[ir.Loop, bool] = {}  # cache of `names_attributes`
        self.calls: dict[ir.Loop, list[ast.Call]] = {}  # cache of `_calls`
        self.sending: dict[str, bool] = {}  # name → whether a call of it publishes
        self.rows: dict[ir.Loop, Literal["direct", "helper", ""]] = {}

    def inside(self, code: Hashable, nodes: Sequence[ast.AST]) -> bool:
        """Return whether syntax trees register something or make objects; `code` identifies the trees."""
        found = self.known.get(code)
        if found is None:
            found = self.known[code] = self._search(_called(nodes), self.wanted, self.known)
        return found

    def calls_element(self, code: Hashable, target: ir.Expr | None, nodes: Sequence[ast.AST]) -> bool:
        """Return whether code calls a variable of the loop around the code. The variable may hold a class."""
        found = self.calling.get(code)
        if found is None:
            names = _names(target)
            called = (one.func for one in walk(*nodes) if isinstance(one, ast.Call))
            found = any(_is_one(one, names) for one in called)
            self.calling[code] = found
        return found

    def asks(self, loop: ir.Loop) -> bool:
        """Return whether a loop calls methods of its elements, and conditions decide what follows in the loop.

        An earlier element may then decide whether a method of a later element is called, as in a behaviour tree.
        """
        found = self.asking.get(loop)
        if found is None:
            decides = any(isinstance(one, DECIDING) for one in walk(*loop.nodes))
            found = self.asking[loop] = decides and calls_method_of(loop.target, loop.nodes)
        return found

    def names_attributes(self, loop: ir.Loop) -> bool:
        """Return whether a variable of a loop is the name of an attribute that the loop reads or stores."""
        found = self.naming.get(loop)
        if found is None:
            names = _names(loop.target)
            found = self.naming[loop] = any(
                isinstance(one.func, ast.Name)
                and one.func.id in BY_NAME
                and len(one.args) > 1
                and _mentions(one.args[1], names)
                for one in self._calls(loop)
            )
        return found

    def _calls(self, loop: ir.Loop) -> list[ast.Call]:
        """Return the calls in the body of a loop."""
        found = self.calls.get(loop)
        if found is None:
            found = self.calls[loop] = [one for one in walk(*loop.nodes) if isinstance(one, ast.Call)]
        return found

    def publishes(self, loop: ir.Loop) -> Literal["direct", "helper", ""]:
        """Return the code in which a loop's element chooses a publisher: the body, a called function, or none.

        A loop over publishers that all get the same message does not count.
        """
        found = self.rows.get(loop)
        if found is None:
            found = self.rows[loop] = self._publishes(loop)
        return found

    def _publishes(self, loop: ir.Loop) -> Literal["direct", "helper", ""]:
        targets = _names(loop.target)
        helpers: list[str] = []
        for one in self._calls(loop):
            name = last_name(one.func)
            if not name:
                continue
            receiver = one.func.value if isinstance(one.func, ast.Attribute) else one.func
            if name in SENDING and _mentions(receiver, targets):
                if len(targets) > 1 or not isinstance(receiver, ast.Name):
                    return "direct"
            elif any(_mentions(given, targets) for given in [*one.args, *(k.value for k in one.keywords)]):
                helpers.append(name)
        return "helper" if self._search(helpers, SENDING, self.sending) else ""

    def _search(self, names: Iterable[str], wanted: Set[str], known: MutableMapping[Any, bool]) -> bool:
        """Search functions, and all functions that they may call, for calls of wanted names."""
        bodies = self._bodies()
        seen: set[str] = set()
        pending = [*names]
        while pending:
            name = pending.pop()
            if name in wanted or known.get(name):
                return True
            if name in bodies and name not in seen and name not in known:
                seen.add(name)
                if name not in self.called:
                    self.called[name] = frozenset(_called(bodies[name]))
                pending += self.called[name]
        known.update(dict.fromkeys(seen, False))
        return False

    def _bodies(self) -> dict[str, list[ast.AST]]:
        """Return the code of each name; note the names of classes, and of functions that define functions."""
        if self.bodies is None:
            self.bodies = {}
            for node in _definitions(self.trees):
                code = [node] if isinstance(node, FUNCTIONS) else _constructor(node)
                self.bodies.setdefault(node.name, []).extend(code)
                if _makes(node):
                    self.known[node.name] = True
        return self.bodies


def _definitions(trees: Iterable[ast.Module]) -> Iterator[Function | ast.ClassDef]:
    """Yield the functions and classes of files; expressions are not searched."""
    pending: list[ast.AST] = [*trees]
    while pending:
        node = pending.pop()
        if isinstance(node, (*FUNCTIONS, ast.ClassDef)):
            yield node
        pending += [one for one in children(node) if not isinstance(one, ast.expr)]


def _makes(node: Function | ast.ClassDef) -> bool:
    """Return whether a call makes an object with data of its own, or a function."""
    if isinstance(node, ast.ClassDef):
        return not any(last_name(base).endswith(VALUES) for base in node.bases)
    return any(isinstance(s, FUNCTIONS) for s in node.body)


def _constructor(node: ast.ClassDef) -> list[ast.AST]:
    """Return the code that runs when a class is called: its own constructors, and calls of its base classes."""
    own = [s for s in node.body if isinstance(s, FUNCTIONS) and s.name in CONSTRUCTORS]
    return [*own, *(ast.Call(base, [], []) for base in node.bases)]


def _names(target: ir.Expr | None) -> frozenset[str]:
    """Return the variables that a loop assigns its elements to."""
    if isinstance(target, ir.SequenceDisplay):
        return frozenset().union(*map(_names, target.items))
    if isinstance(target, ir.Name):
        return frozenset([target.name.partition("<")[0]])  # variables of comprehensions have unique names
    return frozenset()


def calls_method_of(target: ir.Expr | None, nodes: Sequence[ast.AST]) -> bool:
    """Return whether code calls a method of a variable of the loop around the code."""
    names = _names(target)
    called = (one.func for one in walk(*nodes) if isinstance(one, ast.Call))
    return any(isinstance(one, ast.Attribute) and _is_one(_indexed(one.value), names) for one in called)


def _indexed(expr: ast.expr) -> ast.expr:
    """Return the index of an expression such as `children[number]`; any other expression is returned as it is."""
    return expr.slice if isinstance(expr, ast.Subscript) else expr


def _is_one(expr: ast.expr, names: Set[str]) -> bool:
    return isinstance(expr, ast.Name) and expr.id in names


def _mentions(expr: ast.expr, names: Set[str]) -> bool:
    return any(isinstance(one, ast.Name) and one.id in names for one in walk(expr))


def _called(nodes: Iterable[ast.AST]) -> Iterator[str]:
    """Yield the last parts of the names of called functions, except constructors of base classes."""
    for one in walk(*nodes):
        if isinstance(one, ast.Call) and (name := last_name(one.func)) and name not in CONSTRUCTORS:
            yield ADDS_STATE if name == "add" and _adds_state(one) else name


def _adds_state(call: ast.Call) -> bool:
    """Return whether a call of a method `add` may add a state to a machine."""
    if any(keyword.arg in STATE_KEYWORDS for keyword in call.keywords):
        return True
    return isinstance(call.func, ast.Attribute) and last_name(call.func.value) in MACHINES
