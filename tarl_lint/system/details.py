"""What the table of a text report leaves out of a node: remappings, parameters, services and actions."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Final

from tarl_lint.files import shown
from tarl_lint.report.line import Glyphs
from tarl_lint.system.model import Instance, Role
from tarl_lint.workspace.bounded_files import UnreadableError
from tarl_lint.workspace.launch_parameters import leaves, stated
from tarl_lint.workspace.parameter_yaml import NoYamlError

_OFFERS: Final[Mapping[Role, str]] = {"serves": "serves", "calls": "calls", "performs": "action server of"}


def details(instance: Instance, glyphs: Glyphs) -> str:
    """Return the remappings, services and actions of a node, with names as launched, and its number of parameters.

    Returns "" if it has none.
    """
    return "; ".join((*_remaps(instance, glyphs), *_parameters(instance), *_offers(instance)))


def _remaps(instance: Instance, glyphs: Glyphs) -> Iterator[str]:
    named = dict.fromkeys(f"{old} {glyphs.arrow} {instance.resolve(old)}" for old, _ in instance.node.remaps)
    if named:
        yield f"remaps {', '.join(named)}"


def _parameters(instance: Instance) -> Iterator[str]:
    settings = instance.node.settings
    if not settings:
        return
    files = ", ".join(dict.fromkeys(shown(one.file) for one in settings))
    try:
        values = {one.name: one.value for one in stated(settings, instance.name)}
    except (NoYamlError, UnreadableError):
        yield f"parameters from {files}"
        return
    count = sum(1 for _ in leaves(values))
    if count:
        yield f"{count} {'parameter' if count == 1 else 'parameters'} from {files}"


def _offers(instance: Instance) -> Iterator[str]:
    for role, word in _OFFERS.items():
        names = dict.fromkeys(name for name, _ in instance.named(role))
        if names:
            yield f"{word} {', '.join(names)}"
