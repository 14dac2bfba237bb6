"""Keep the interfaces of programs between runs, by the texts of a program and its imports."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any, Final

from tarl_lint.model import Cut, Finding, Span
from tarl_lint.parameter_names import ParameterName
from tarl_lint.read.source import Script, SourceError
from tarl_lint.run.cache import Cache, digest, packed, unpacked
from tarl_lint.system.model import Endpoint, Interface, Misfit, Qos

# number of additional entries, for other launch files and file versions
SPARE: Final = 1000
# first item of an entry for a broken file; in other entries, it is a path
_BROKEN: Final = 0


def key(
    script: Script, entry: str, package: str, imported: Sequence[Script], fixed: Mapping[str, object]
) -> str:
    """Return the key of a program: all facts on which the program's interface depends, except the settings."""
    scripts = [
        part
        for one in (script, *imported)
        for part in (one.path, one.name, str((one.is_package, one.installed, one.started)), one.text)
    ]
    return digest([entry, package, repr(sorted(fixed.items(), key=lambda one: one[0])), *scripts])


def kept(cache: Cache, name: str) -> Interface | SourceError | None:
    """Return the interface under a key, or the error in the program's file; None without an entry."""
    entry = cache.entry(name)
    if entry is None:
        return None
    if entry[0] == _BROKEN:
        return SourceError(*entry[1:])
    values = zip(Interface.__dataclass_fields__, entry, strict=True)
    return Interface(**{field: _PARTS.get(field, _same)(value) for field, value in values})


def keep(cache: Cache, name: str, interface: Interface | SourceError) -> None:
    """Store an interface under a key."""
    if isinstance(interface, SourceError):
        error = interface
        cache.put_entry(name, [_BROKEN, error.path, error.line, error.message, error.bug])
    else:
        cache.put_entry(name, packed(interface))


def _same(value: Any) -> Any:
    return value


def _endpoint(entry: Sequence[Any]) -> Endpoint:
    role, names, kind, span, qos, place, written, whole_type, driven = entry
    profile = None if qos is None else Qos(*qos)
    return Endpoint(role, tuple(names), kind, Span(*span), profile, place, tuple(written), whole_type, driven)


def _findings(entries: Sequence[Any]) -> tuple[Finding, ...]:
    return tuple(unpacked(Finding, one) for one in entries)


def _misfit(entry: Sequence[Any]) -> Misfit:
    kind, field, span, place = entry
    return Misfit(kind, field, Span(*span), place)


_PARTS: Final[Mapping[str, Callable[[Any], Any]]] = {
    "endpoints": lambda entries: tuple(map(_endpoint, entries)),
    "flows": _findings,
    "stale": _findings,
    "words": frozenset,
    "private": frozenset,
    "exact": lambda names: None if names is None else frozenset(names),
    "private_words": frozenset,
    "public": frozenset,
    "misfits": lambda entries: tuple(map(_misfit, entries)),
    "uses": lambda entries: tuple(map(_misfit, entries)),
    "deciding": tuple,
    "configured": tuple,
    "cut": lambda entries: tuple(Cut(*one) for one in entries),
    "in_names": lambda entries: tuple(ParameterName(*one) for one in entries),
}
