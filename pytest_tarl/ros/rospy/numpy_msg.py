"""`numpy_msg(Type)`: received messages have numpy arrays instead of tuples of numbers."""

from __future__ import annotations

from functools import cache
from typing import Any

from pytest_tarl.ros.messages.field_values import CODES

__all__ = ["numpy_msg"]


@cache
def numpy_msg(msg_type: Any) -> Any:
    """Return a class of the same type whose received messages have numpy arrays."""
    names = {slot: kind.partition("[")[0] for slot, kind in zip(msg_type.__slots__, msg_type._slot_types, strict=True)
             if "[" in kind and kind.partition("[")[0] in CODES}  # fmt: skip

    def copy(message: Any) -> Any:
        import numpy as np

        twin = msg_type._tarl_copy(message)
        twin.__class__ = made
        for name, base in names.items():
            value = getattr(twin, name)
            kind = {"char": "uint8", "byte": "int8"}.get(base, base)
            array = (
                np.frombuffer(value, dtype=kind) if isinstance(value, bytes) else np.array(value, dtype=kind)
            )
            setattr(twin, name, array.copy())
        return twin

    made: Any = type(f"Numpy_{msg_type._type.replace('/', '__')}", (msg_type,), {
        "__slots__": [], "__module__": msg_type.__module__, "_tarl_copy": staticmethod(copy),
    })  # fmt: skip
    made.__slots__ = msg_type.__slots__
    return made
