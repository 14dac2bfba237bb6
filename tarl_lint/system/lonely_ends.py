"""Find ends of topics, services and actions that have no other end, and the ends that were probably meant to be it."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Final, NamedTuple

from tarl_lint.system.model import Endpoint, Instance, System, mention
from tarl_lint.system.similar_names import (
    in_private_names,
    longer_alike,
    misspelt,
    spelled_alike,
    under_own_name,
)
from tarl_lint.workspace.conditions import exclusive

_GENERAL: Final = frozenset(["Trigger", "SetBool", "Empty"])  # types of services that many nodes offer


class Lonely(NamedTuple):
    """An end of a topic, service or action without a known other end, by its launched name."""

    name: str
    node: Instance
    end: Endpoint


def near(system: System, one: Lonely, others: Iterable[Lonely], *, longer: bool = False) -> list[Lonely]:
    """Return the ends that were probably meant to be the other end of an end, each node and name once, sorted.

    An unread node may be the other end of both names. It does not matter for private names, because only the node
    itself uses these. It matters for misspelt names only if it mentions one of the two names. With `longer`, names
    may also differ by whole words; in the root namespace, this holds only for special types.
    """
    able = tuple(system.able(one.end))
    found = {
        (other.name, other.node.name): other
        for other in others
        if not exclusive(one.node.node, other.node.node)
        and _alike(one, other, longer=longer)
        and (_certain(one, other, able) or not _explained(system, one, other, able))
    }
    return [found[key] for key in sorted(found)]


def _explained(system: System, one: Lonely, other: Lonely, able: Iterable[Instance]) -> bool:
    """Return whether an unread node or file may contain the other end of one of two ends.

    `able` are the nodes that may use their type.
    """
    names = one.name, other.name
    return system.hides(one.end, *names) or any(
        any(map(node.may_name, names)) or mention(_texts(node), names) for node in able
    )


def _alike(one: Lonely, other: Lonely, *, longer: bool) -> bool:
    return (
        spelled_alike(one.name, other.name)
        or (longer and longer_alike(one.name, other.name, rooted=one.end.type not in _GENERAL))
        or in_private_names(one.name, other.name, one.node, other.node)
        or under_own_name(one.name, other.name, other.node)
    )


def _certain(one: Lonely, other: Lonely, able: Iterable[Instance]) -> bool:
    """Return whether two ends belong together, even if other nodes may use their type."""
    if other.node.name == one.name.rpartition("/")[0] or under_own_name(one.name, other.name, other.node):
        return True
    if not misspelt(one.name, other.name):
        return False
    others = (node for node in able if node not in (one.node, other.node))
    return not any(mention(_texts(node), (one.name, other.name)) for node in others)


def _texts(node: Instance) -> Iterator[str]:
    """Yield the texts in which a node may mention topics: its remappings, arguments, parameters and strings."""
    launched = node.node
    yield launched.arguments
    yield from (name for pair in launched.remaps for name in pair)
    yield from (text for one in launched.settings for text in (str(one.value), one.yaml or ""))
    if node.interface is not None:
        yield from node.interface.words
