"""Details of a node that the table of a text report leaves out: remappings, parameters, services and actions."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from typing import Any, Final

from tarl_lint.files import shown
from tarl_lint.report.line import Glyphs
from tarl_lint.system.model import Instance, Role
from tarl_lint.workspace.bounded_files import UnreadableError
from tarl_lint.workspace.launch_model import Setting
from tarl_lint.workspace.launch_parameters import leaves, stated
from tarl_lint.workspace.parameter_yaml import NoYamlError

_OFFERS: Final[Mapping[Role, str]] = {"serves": "serves", "calls": "calls", "performs": "action server of"}


def details(instance: Instance, shared: Sequence[Setting], glyphs: Glyphs) -> str:
    """Return the remappings, services and actions of a node, as launched, and the number of its parameters.

    `shared` are the settings of the launch file outside its nodes. Returns "" if the node has no details.
    """
    return "; ".join((*_remaps(instance, glyphs), *_parameters(instance, shared), *_offers(instance)))


def _remaps(instance: Instance, glyphs: Glyphs) -> Iterator[str]:
    named = dict.fromkeys(f"{old} {glyphs.arrow} {instance.resolve(old)}" for old, _ in instance.node.remaps)
    if named:
        yield f"remaps {', '.join(named)}"


def _parameters(instance: Instance, shared: Sequence[Setting]) -> Iterator[str]:
    above = f"{instance.name}/"
    own = instance.node.settings
    files = dict.fromkeys(shown(one.file) for one in own)
    values: dict[str, Any] = {}
    try:
        for one in stated(own, instance.name):
            values[f"{above}{one.name[1:].lstrip('/')}" if one.name.startswith("~") else one.name] = one.value
    except (NoYamlError, UnreadableError):
        yield f"parameters from {', '.join(files)}"
        return
    for setting in shared:
        with suppress(NoYamlError, UnreadableError):  # another part of the report names the unreadable file
            inside = [one for one in stated((setting,), instance.name) if one.name.startswith(above)]
            values.update((one.name, one.value) for one in inside)
            files.update((shown(one.file), None) for one in inside)
    count = sum(1 for _ in leaves(values))
    if count:
        yield f"{count} {'parameter' if count == 1 else 'parameters'} from {', '.join(files)}"


def _offers(instance: Instance) -> Iterator[str]:
    for role, word in _OFFERS.items():
        names = dict.fromkeys(name for name, _ in instance.named(role))
        if names:
            yield f"{word} {', '.join(names)}"
