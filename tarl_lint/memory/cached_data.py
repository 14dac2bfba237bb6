"""Results of searches for the data inside objects, kept for the next search of the same run."""

from __future__ import annotations

from dataclasses import dataclass

from tarl_lint.memory.reads import Reads
from tarl_lint.memory.values import Key, Nodes, Obj, Value

State = tuple[int, int, bool, str]


@dataclass(slots=True, eq=False)
class Contents:
    """The data in one object, without the data in the objects to which its fields point.

    `state` changes whenever something is stored in the object, or in another part of the object to which it
    belongs.
    """

    obj: Obj
    state: State
    nodes: Nodes  # data of the fields that are known by name
    summary: Nodes  # data of all elements and unknown fields
    all: Nodes  # `nodes` and `summary`
    summarised: bool  # whether the object has a summary field of its own
    overwritten: bool  # whether this run has overwritten every field of a message
    # values of the fields from which the search has to go on, in the order of the fields: pointers, and constants
    # with data
    steps: tuple[Value, ...]
    constants: frozenset[int]  # positions in `steps` of values that are the same constant on all paths
    parts: tuple[Obj, ...]
    keys: set[Key]
    stored: set[Key]
    objects: dict[Obj, int]

    def alike(self, other: Contents) -> bool:
        """Return whether a search finds the same data here as in other contents of the same object."""
        return (
            self.nodes == other.nodes
            and self.steps == other.steps
            and self.parts == other.parts
            and self.summary == other.summary
            and self.summarised is other.summarised
            and self.overwritten is other.overwritten
            and self.constants == other.constants
        )


@dataclass(slots=True, eq=False)
class Inside:
    """A cached result of `deep`: the data inside objects, and the reads that the result depends on."""

    nodes: frozenset[int]
    reads: Reads
    read: list[Contents]  # what each visited object contained when the result was computed
    empty: set[Obj]  # objects without data to which the visited objects point
    receivers: bool  # whether the result depends on the receivers of the running methods
    tick: int
    grown: int  # value of `Graph.grown` when the result was cached


@dataclass(slots=True, eq=False)
class Split:
    """The objects of a points-to set that may hold data, in order of creation, and those that hold none."""

    laden: tuple[Obj, ...]
    empty: frozenset[Obj]
    doubted: list[Obj]  # objects without data for which this run has not recorded yet that they are empty
    loaded: int  # value of `Shared.loaded` when the set was split
