"""Topics, services and actions that nodes use, but none offers."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final

from tarl_lint.system.model import Role, System

# names of topics and services of ROS itself, of transforms or of a simulator
_GIVEN: Final = frozenset(["/clock", "/tf", "/tf_static", "/rosout", "/rosout_agg", "/parameter_events"])
_SIDES: Final[tuple[tuple[Role, Role], ...]] = (
    ("subscribes", "publishes"),
    ("calls", "serves"),
    ("asks", "performs"),
)


@dataclass(frozen=True)
class OneSided:
    """A name that nodes use in one role, while no known node has the role `missing`.

    `types` are the types that the users expect. `certain` is True if no unread part of the launch file can be the
    other side.
    """

    name: str
    missing: Role
    types: tuple[str, ...]
    users: tuple[str, ...]
    certain: bool


def one_sided(system: System) -> tuple[OneSided, ...]:
    """Return the one-sided names, sorted by role and name; empty without a launch file.

    Names that ROS itself provides are left out. If the remappings of an unread node mention a name, this node is
    probably the other side, and the name is left out as well. So are names that depend on a value known only on the
    robot.
    """
    return () if system.file.is_dir() else tuple(_one_sided(system))


def _one_sided(system: System) -> Iterator[OneSided]:
    touched = {name for one in system.instances for name in one.touched}
    for role, missing in _SIDES:
        offered = {name for name, _, _ in system.named(missing)} | touched | _GIVEN
        found: dict[str, list[tuple[str, str, bool]]] = {}
        for name, who, end in system.ends(role):
            if name not in offered and "$(" not in name:
                certain = not any(system.able(end)) and not system.hides(end, name)
                found.setdefault(name, []).append((end.type, who.name, certain))
        for name, uses in sorted(found.items()):
            yield OneSided(
                name,
                missing,
                tuple(sorted({kind for kind, _, _ in uses if kind})),
                tuple(sorted({who for _, who, _ in uses})),
                all(certain for _, _, certain in uses),
            )
