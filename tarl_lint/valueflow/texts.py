"""Texts made of known texts: names of topics, parameters, keys."""

from __future__ import annotations

from typing import Any, Final

from tarl_lint.valueflow.futures import Futures
from tarl_lint.valueflow.machine import Arguments, Invocation
from tarl_lint.valueflow.values import UNKNOWN, Consts, Value

TEXT_METHODS: Final = frozenset(
    [
        "format",
        "join",
        "strip",
        "lstrip",
        "rstrip",
        "lower",
        "upper",
        "title",
        "replace",
        "removeprefix",
        "removesuffix",
    ]
)
MAX_TEXT: Final = 300


class Texts(Futures):
    """Folds methods of texts."""

    def text_of(self, base: Value, name: str, arguments: Arguments) -> Consts:
        """Return the text that a method of a known text gives, None when something of it is not known."""
        known, text = base.constant()
        plain = [self._known(v) for v in arguments[0]]
        named = {key: self._known(v) for key, v in arguments[1].items()}
        if not known or not isinstance(text, str) or None in plain or None in named.values():
            return None
        try:
            made = getattr(text, name)(
                *(p[0] for p in plain if p), **{k: v[0] for k, v in named.items() if v}
            )
        except Exception:  # whatever the program itself would fail with
            return None
        return frozenset([made]) if isinstance(made, str) and len(made) <= MAX_TEXT else None

    def _known(self, value: Value) -> tuple[Any] | None:
        """Return a known constant, or a list of such, in a tuple."""
        known, constant = value.constant()
        if known:
            return (constant,)
        elements = self.unpacked(value)
        inside = [e.constant() for e in elements or ()]
        return ([c for _, c in inside],) if elements is not None and all(k for k, _ in inside) else None

    def remainder(self, values: list[Value]) -> Consts:
        """Return `text % values` where all is known."""
        first, second = (self._known(v) for v in values)
        if first is None or second is None or not isinstance(first[0], str):
            return None
        given = tuple(second[0]) if isinstance(second[0], list) else second[0]
        try:
            made = first[0] % given
        except Exception:  # whatever the program itself would fail with
            return None
        return frozenset([made]) if len(made) <= MAX_TEXT else None

    def as_text(self, it: Invocation) -> Value:
        """Return `str(x)`."""
        deps = self.all_used(it.arguments)
        known, constant = it.arguments[0][0].constant() if len(it.arguments[0]) == 1 else (False, None)
        return Value(deps, consts=frozenset([str(constant)]) if known else None)

    def same_text(self, it: Invocation) -> Value:
        """Return a name that a function resolves, as it is written."""
        return it.arguments[0][0] if it.arguments[0] else UNKNOWN

    def joined_path(self, it: Invocation) -> Value:
        """Return the names joined by slashes."""
        parts = [self._known(v) for v in it.arguments[0]]
        texts = [str(p[0]) for p in parts if p is not None]
        whole = frozenset(["/".join(t.rstrip("/") for t in texts)]) if len(texts) == len(parts) else None
        return Value(self.all_used(it.arguments), consts=whole)
