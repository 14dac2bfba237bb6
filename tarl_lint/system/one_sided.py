"""Topics, services and actions of a launch file with one known side: heard, called or asked for, but not offered."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final

from tarl_lint.system.model import Role, System

# names that ROS itself, transforms or a simulator provide
_GIVEN: Final = frozenset(["/clock", "/tf", "/tf_static", "/rosout", "/rosout_agg", "/parameter_events"])
_SIDES: Final[tuple[tuple[Role, Role], ...]] = (
    ("subscribes", "publishes"),
    ("calls", "serves"),
    ("asks", "performs"),
)


@dataclass(frozen=True)
class OneSided:
    """A name that nodes use in one role, while no known node has the role `missing`.

    `types` are the types that the users expect. `certain` says that no part of the launch file that was not read can
    be the other side.
    """

    name: str
    missing: Role
    types: tuple[str, ...]
    users: tuple[str, ...]
    certain: bool


def one_sided(system: System) -> tuple[OneSided, ...]:
    """Return the one-sided names, sorted by role and name. Without a launch file there are none.

    Names that ROS itself provides are left out, and names that the remappings of a node mention whose code was not
    read: this node is probably the other side. So are names that depend on a value that only the robot knows.
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
