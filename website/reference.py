"""Generate the reference pages from the code: options, commands, settings, schemas, the API."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from pytest_tarl.flags import FLAGS
from tarl_lint.settings.schema import KEYS
from website.pages import schemas

COMMANDS = (
    ("tarl", ()),
    ("tarl", ("show",)),
    ("tarl", ("diff",)),
    ("tarl", ("apply",)),
    ("tarl", ("revert",)),
    ("tarl", ("suggest",)),
    ("tarl", ("observe",)),
    ("tarl", ("watch",)),
    ("tarl", ("workspace",)),
    ("tarl-lint", ()),
)
PUBLIC = {
    "For tests": (
        "pytest_tarl.episode.Tarl",
        "pytest_tarl.sensors.Sensor",
        "pytest_tarl.drifts.Drift",
        "pytest_tarl.formulas.signals.Signal",
    ),
    "For worlds": ("pytest_tarl.ros.message_type", "pytest_tarl.ros.Bus"),
    "For searches of your own": (
        "pytest_tarl.searching.ask_tell.Constant",
        "pytest_tarl.searching.ask_tell.Optimiser",
    ),
    "For programs that lint": ("tarl_lint.api",),
}


def _cell(words: str) -> str:
    return words.replace("|", "\\|")


def options() -> str:
    """Return the page on the plugin's options."""
    rows = [
        f"| `{flag.name}{f' {flag.metavar}' if flag.metavar else ''}` | {_cell(flag.help)} |"
        for flag in FLAGS
    ]
    return "\n".join(
        [
            "# Options of pytest",
            "",
            "`pytest --help` lists the same options. The [guide](../guide.md) explains the modes.",
            "",
            "| option | effect |",
            "|---|---|",
            *rows,
            "",
        ]
    )


def commands() -> str:
    """Return the page on the commands, with the help of each."""
    lines = ["# Commands", "", "Each command prints this text with `--help`.", ""]
    for program, words in COMMANDS:
        name = " ".join((program, *words))
        lines += [f"## {name}", "", "```text", _help(program, words), "```", ""]
    return "\n".join(lines)


def _help(program: str, words: tuple[str, ...]) -> str:
    """Return a command's --help output, 100 columns wide."""
    module = {"tarl": "pytest_tarl.commands.cli", "tarl-lint": "tarl_lint.cli"}[program]
    code = f"import sys; sys.argv[0] = {program!r}; from {module} import main; main(sys.argv[1:])"
    environment = {**os.environ, "COLUMNS": "100", "NO_COLOR": "1"}
    called = [sys.executable, "-c", code, *words, "--help"]
    return subprocess.run(called, env=environment, capture_output=True, text=True, check=True).stdout.strip()


def settings() -> str:
    """Return the page on tarl-lint's settings."""
    rows = [f"| `{key}` | {_cell(kind)} |" for key, (_, kind) in KEYS.items()]
    return "\n".join(
        [
            "# Settings of tarl-lint",
            "",
            "The table `[tool.tarl-lint]` of `pyproject.toml` holds these keys.",
            "[tarl-lint](../lint.md#settings) explains each key and shows an example with all of them.",
            "",
            "| key | value |",
            "|---|---|",
            *rows,
            "",
        ]
    )


def schema_page() -> str:
    """Return the page that lists the JSON schemas."""
    rows = []
    for path in schemas():
        schema: Mapping[str, Any] = json.loads(path.read_text("utf-8"))
        rows.append(f"| [{schema['title']}](../schemas/{path.name}) | `schemas/{path.name}` |")
    return "\n".join(
        [
            "# JSON schemas",
            "",
            "The schemas follow JSON Schema 2020-12. The key `format` of a document holds the version of its format,",
            "which increases if a key or its meaning changes. The addresses below do not change: on the published",
            "site, the folder `schemas` is beside the folders of the versions of the documentation.",
            "",
            "| document | address relative to the root of the site |",
            "|---|---|",
            *rows,
            "",
        ]
    )


def api() -> str:
    """Return the page on the public API, filled by mkdocstrings."""
    lines = ["# Python API", ""]
    for group, names in PUBLIC.items():
        lines += [f"## {group}", ""]
        for name in names:
            lines += [f"::: {name}", "    options:", "      heading_level: 3", ""]
    return "\n".join(lines)


def write(staged: Path) -> None:
    """Write the generated reference pages."""
    folder = staged / "reference"
    folder.mkdir(exist_ok=True)
    pages = {
        "options": options,
        "commands": commands,
        "settings": settings,
        "schemas": schema_page,
        "api": api,
    }
    for name, page in pages.items():
        (folder / f"{name}.md").write_text(page(), "utf-8")
