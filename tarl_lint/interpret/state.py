"""Parts of the interpreter's state: nullness facts, and the work done."""

from __future__ import annotations

from collections.abc import Hashable
from dataclasses import dataclass, field

from tarl_lint.interpret.budget import MAX_STATEMENTS, PROGRAM_LIMIT, VALUES_HANDLED
from tarl_lint.ir import nodes as ir
from tarl_lint.memory.value_flow_graph import MAX_EDGES
from tarl_lint.memory.values import Key


@dataclass(slots=True, eq=False)
class NullnessFacts:
    """Facts about values that are None before the first message; all sets only grow."""

    vacant: set[Key] = field(
        default_factory=set
    )  # variables and fields that are None before the first message
    optional: set[Key] = field(default_factory=set)  # variables and fields that may be None because of data
    # names of properties with a setter, and names of the methods of descriptors that classes define
    setters: set[str] = field(default_factory=set)
    doubtful: set[ir.Call] = field(default_factory=set)  # calls whose result may be None because of data
    came: dict[Key, set[int]] = field(
        default_factory=dict
    )  # copy of a variable in `vacant` → the nodes that decide whether the copy is set
    came_out: dict[ir.Call, set[int]] = field(
        default_factory=dict
        # call that returns a copy of a variable in `vacant` → the nodes that decide whether the copy is set
    )

    def of_key(self, key: Key | None) -> tuple[bool, bool, int]:
        """Return the facts about a key; without one, whether data may make any value None."""
        if key is None:
            return False, bool(self.optional), 0
        return key in self.vacant, key in self.optional, len(self.came.get(key, ()))

    def of_result(self, call: ir.Call) -> tuple[bool, int]:
        """Return the facts about a call's result."""
        return call in self.doubtful, len(self.came_out[call]) if call in self.came_out else -1


@dataclass(slots=True, eq=False)
class Registered:
    """The calls that register a root, as nodes that depend on the conditions of these calls."""

    node: int | None = None  # the node on which the root's publish calls depend
    # node of a call → the roots that make it
    ways: dict[int, set[Hashable]] = field(default_factory=dict)
    plain: bool = False  # whether it is registered outside the code, and therefore without conditions


@dataclass(slots=True, eq=False)
class Work:
    """The work done, in statements: in this run of a root, and by each program in earlier runs."""

    spent: int = 0  # number of statements of work in this run
    saved: int = 0  # the part of `spent` that was done in replayed calls
    # number of values that this run handled while it searched for data, recorded calls, and returned from calls
    handled: int = 0
    idled: int = 0  # the part of `spent` that was done in calls into modules without ROS calls
    limit: int = MAX_STATEMENTS
    # value of `spent` at which the current call into a module without ROS calls ends; None outside such a call
    call_limit: int | None = None
    # function → number of its executions in this run
    activations: dict[ir.Function, int] = field(default_factory=dict)
    # program → number of statements in earlier runs, without replayed calls
    totals: dict[str, int] = field(default_factory=dict)
    edges_of: dict[str, int] = field(default_factory=dict)  # program → number of edges that it has made
    nodes_of: dict[str, int] = field(default_factory=dict)  # program → number of nodes that it has made
    frames_of: dict[str, int] = field(default_factory=dict)  # program → number of its call contexts

    # file that is not a program → the files that import it, and whether each is the `__init__.py` of a package
    importers: dict[str, dict[str, bool]] = field(default_factory=dict)
    owners: dict[str, str] = field(default_factory=dict)  # cache of `charged_to`: file → program

    def charged_to(self, path: str) -> str:
        """Return the program whose budget a file's roots use: the first program that imports the file, even indirectly.

        A package's `__init__.py` that nothing imports counts as a program only if there is no other program.
        """
        owner = self.owners.get(path)
        if owner is None:
            package = {path: False}  # file reached so far → whether it is the `__init__.py` of a package
            for current in (pending := [path]):
                above = self.importers.get(current, {})
                pending += [p for p in above if p not in package]
                package = {**above, **package}
            tops = [p for p in pending if not self.importers.get(p)]
            owner = self.owners[path] = min(tops or [path], key=package.__getitem__)
        return owner

    @property
    def total(self) -> int:
        """Return the work of all earlier runs."""
        return sum(self.totals.values())

    @property
    def executed(self) -> int:
        """Return the work of this run so far, without replayed calls."""
        return self.spent - self.saved

    @property
    def charged(self) -> int:
        """Return the part of the budget that this run has used so far, in statements."""
        return self.executed + self.handled // VALUES_HANDLED

    def begin(self, limit: int) -> None:
        """Start counting for a run of a root."""
        self.spent = self.saved = self.idled = self.handled = 0
        self.limit, self.call_limit = limit, None
        self.activations.clear()

    def exhausted(self, program: str) -> bool:
        """Return whether the program of a file has used its budget."""
        charged = self.totals.get(self.charged_to(program), 0)
        return charged > PROGRAM_LIMIT or self.edges_of.get(program, 0) >= MAX_EDGES
