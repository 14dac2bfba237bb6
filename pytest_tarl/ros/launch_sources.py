"""The settings that launch files give a script, and advice for a node without a parameter or command line."""

from __future__ import annotations

import shlex
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Final

SHOWN: Final = 2  # maximum number of launch files in one sentence
_LONGEST: Final = 40  # maximum characters of a value in a sentence


@dataclass(frozen=True)
class Source:
    """A launch file that starts the script as `node`, and the values that it gives.

    `name` is how `tarl.launch` finds the file. `argv` may contain substitutions that are known only on the robot;
    `valueless` names the parameters with such substitutions. `required` has the launch arguments that need a value.
    """

    file: Path
    name: str
    node: str
    argv: tuple[str, ...] = ()
    parameters: Mapping[str, Any] = field(default_factory=dict)
    valueless: tuple[str, ...] = ()
    required: tuple[str, ...] = ()

    @property
    def complete(self) -> bool:
        """Return whether all that the file gives the node is known without further launch arguments."""
        return not self.valueless and not any("$(" in one for one in self.argv)

    @property
    def call(self) -> str:
        """Return the call that starts the node in the way of this launch file."""
        values = ", ".join(f'"{one}": …' for one in self.required)
        arguments = f", arguments={{{values}}}" if values else ""
        return f'tarl.launch("{self.name}"{arguments}, only=["{self.node}"])'


@dataclass(frozen=True)
class Given:
    """What launch files give a script: `private` parameters by name, `shared` ones by absolute name, and `argv`.

    - `note`: names the file
    - `node`: the node's absolute name if `tarl.launch` starts it; empty for `tarl.start`
    - `valueless`: parameters without a usable value, because it is known only at launch or is null in YAML, which ROS 1
      cannot store
    - `sources`: all launch files that start the script
    """

    private: Mapping[str, Any] = field(default_factory=dict)
    shared: Mapping[str, Any] = field(default_factory=dict)
    note: str = ""
    node: str = ""
    valueless: tuple[str, ...] = ()
    argv: tuple[str, ...] = ()
    sources: tuple[Source, ...] = ()

    @property
    def gives(self) -> bool:
        """Return whether there is any parameter or argument."""
        return bool(self.private or self.shared or self.argv)


NOTHING: Final = Given()


def parameter_from(sources: Sequence[Source], name: str) -> str:
    """Return a sentence on the launch files that set a parameter of the script; empty if there are none."""

    def stated(source: Source) -> str:
        shown = name if name.startswith("/") else f"~{name}"
        if name in source.valueless:
            return f"{shown} from its launch arguments" if source.required else ""
        return f"{shown}:={_short(source.parameters[name])}" if name in source.parameters else ""

    return _sentence(sources, stated)


def arguments_from(sources: Sequence[Source]) -> str:
    """Return a sentence on the launch files that give the script a command line; empty if there are none."""

    def stated(source: Source) -> str:
        words = [one if "$(" in one else shlex.quote(one) for one in source.argv]
        return f"the arguments `{_short(' '.join(words))}`" if words else ""

    return _sentence(sources, stated)


def _sentence(sources: Sequence[Source], stated: Callable[[Source], str]) -> str:
    """Return what the launch files give the node, with the calls that use them."""
    giving = {(one.file, stated(one)): (one, stated(one)) for one in reversed(sources) if stated(one)}
    if not giving:
        return ""
    (first, text), *others = list(reversed(giving.values()))[:SHOWN]
    more = f" (and {len(giving) - SHOWN} more)" if len(giving) > SHOWN else ""
    further = "".join(f", and {one.file.name} with {text}" for one, text in others)
    calls = " or ".join(dict.fromkeys(one.call for one in (first, *(one for one, _ in others))))
    return f"{first.file.name} starts this node with {text}{further}{more}: use {calls}"


def _short(value: Any) -> str:
    text = " ".join(str(value).split())
    return text if len(text) <= _LONGEST else f"{text[: _LONGEST - 1]}…"
