"""The blackboard of py_trees: clients share its keys and see those below their namespace."""

from __future__ import annotations

from collections.abc import Hashable
from dataclasses import dataclass, field
from typing import Final

from tarl_lint.interpret.interpreter import Interpreter
from tarl_lint.memory import recency
from tarl_lint.memory.values import Obj, Value, pointer

CLIENT: Final = "blackboard client"  # kind of the object for a client, through which the keys are seen
BOARD: Final = "blackboard"


@dataclass(frozen=True, slots=True)
class Naming:
    """How a client names keys: below a namespace, or by other names."""

    namespace: str = "/"
    remapped: tuple[tuple[str, str], ...] = field(default=())

    def absolute(self, key: str) -> str:
        """Return the name of a key on the blackboard."""
        whole = key if key.startswith("/") else f"{self.namespace.rstrip('/')}/{key}"
        return dict(self.remapped).get(whole, whole)


def board(ctx: Interpreter) -> Obj:
    """Return the object that holds the values of all keys."""
    return recency.intern(ctx, "record", BOARD, BOARD)


def client(ctx: Interpreter, key: Hashable, namespace: str) -> Value:
    """Return a client with a namespace."""
    obj = recency.intern(ctx, CLIENT, (BOARD, key))
    naming = Naming(f"/{namespace.strip('/')}")
    if not (isinstance(obj.info, Naming) and obj.info.namespace == naming.namespace):
        obj.describe(naming)
    return pointer(obj)


def remap(client: Obj, key: str, name: str) -> None:
    """Let a client use another key of the blackboard under the name of one of its keys."""
    if isinstance(client.info, Naming):
        whole = Naming(client.info.namespace).absolute(key)
        remapped = {**dict(client.info.remapped), whole: Naming().absolute(name)}
        client.describe(Naming(client.info.namespace, tuple(sorted(remapped.items()))))


def seen_through(ctx: Interpreter, client: Obj, name: str) -> tuple[Obj, str]:
    """Return the object that holds a key of a client, and the name of its field."""
    ctx.store.reads.look(client)
    naming = client.info if isinstance(client.info, Naming) else Naming()
    return board(ctx), naming.absolute(name)
