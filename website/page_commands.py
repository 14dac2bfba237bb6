"""Run the commands on a page, and compare their output with the page.

A block with a title is a file. A `console` block has commands, each after `$ `, and their output. All commands run in
one shell, from top to bottom, starting in an empty folder. A line `...` in the output stands for omitted lines.
Durations and digests are not compared, because they depend on the machine. A block after `<!-- nightly -->` installs
packages, and runs only with TARL_SLOW=1.
"""

from __future__ import annotations

import os
import re
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import AbstractContextManager
from pathlib import Path
from typing import NamedTuple

from website.other_plugins import BLOCKED
from website.pages import ROOT

TUTORIAL = ROOT / "docs" / "tutorial.md"
BLOCK = re.compile(
    r"(<!-- nightly -->\n)?^```(\w+)(?: title=\"([^\"]+)\")?\n(.*?)^```$", re.MULTILINE | re.DOTALL
)
VARIES = re.compile(r"\bin \d+\.\d+s\b(?: \(\d+:\d\d:\d\d\))?|\b[0-9a-f]{7,}\b")
LEFT_OUT = re.compile(r"^\.\.\.\n", re.MULTILINE)
END = "__end of output__"
LIMIT = 300  # time limit of a command in s


class Command(NamedTuple):
    """A command on a page, with the output shown below it."""

    line: str
    output: str


class Block(NamedTuple):
    """A block of a page: a file or a list of commands. `start` and `end` are the offsets of its text."""

    start: int
    end: int
    file: str | None
    text: str
    nightly: bool

    def commands(self) -> list[Command]:
        """Return the commands in a console block."""
        parts = re.split(r"^\$ (.*)\n", self.text, flags=re.MULTILINE)[1:]
        return [Command(line, output) for line, output in zip(parts[::2], parts[1::2], strict=True)]


def blocks(page: str) -> list[Block]:
    """Return the files and console blocks of a page, in order."""
    return [
        Block(found.start(4), found.end(4), found[3], found[4], bool(found[1]))
        for found in BLOCK.finditer(page)
        if found[3] or found[2] == "console"
    ]


def same(shown: str, printed: str) -> bool:
    """Return whether the output on a page matches the printed one, except for varying parts and omitted lines."""
    parts = [re.escape(VARIES.sub("~", part)) for part in LEFT_OUT.split(shown)]
    return re.fullmatch("(?:.*\n)*?".join(parts), VARIES.sub("~", printed)) is not None


def shortened(shown: str, printed: str) -> str:
    """Shorten the printed output to as many first and last lines as the page shows."""
    head, *rest = LEFT_OUT.split(shown, maxsplit=1)
    lines = printed.splitlines(keepends=True)
    if not rest:
        return printed
    first, last = head.count("\n"), rest[0].count("\n")
    return "".join([*lines[:first], "...\n", *lines[len(lines) - last :]])


class Shell(AbstractContextManager["Shell"]):
    """A shell that runs commands one after another in a folder, like a reader's shell."""

    def __init__(self, folder: Path) -> None:
        self._shell = subprocess.Popen(
            ["bash", "--noprofile", "--norc"],
            cwd=folder,
            env=_environment(folder),
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
        )

    def __exit__(self, *_: object) -> None:
        """End the shell."""
        self._shell.kill()
        self._shell.communicate()

    def run(self, line: str) -> str:
        """Run a command and return its output. Raise EOFError if it ends the shell."""
        assert self._shell.stdin is not None
        assert self._shell.stdout is not None
        self._shell.stdin.write(
            f"{line} < /dev/null\necho {END}\n" if "<<" not in line else f"{line}\necho {END}\n"
        )
        self._shell.stdin.flush()
        printed = ""
        for text in self._shell.stdout:
            if text.rstrip("\n").endswith(END):
                return printed + text.rstrip("\n").removesuffix(END)
            printed += text
        raise EOFError(f"the shell ended with `{line}`: {printed}")

    def folder(self) -> Path:
        """Return the working directory of the shell."""
        return Path(self.run("pwd").strip())


def _environment(folder: Path) -> dict[str, str]:
    """Return the environment variables of a new user: our commands on PATH, git without settings, 80 columns."""
    kept = {
        name: value
        for name, value in os.environ.items()
        if not name.startswith(("PYTEST", "GIT_", "GITHUB_", "COV_", "TARL_"))
        and name not in ("CI", "BUILD_NUMBER")  # with these variables, pytest does not shorten lines
    }
    who = {f"GIT_{role}_{what}": value for role in ("AUTHOR", "COMMITTER") for what, value in _WHO.items()}
    return {
        **kept,
        **who,
        "PATH": f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}",
        "HOME": str(folder),
        "GIT_CONFIG_GLOBAL": os.devnull,
        "GIT_CONFIG_NOSYSTEM": "1",
        "GIT_PAGER": "cat",
        "COLUMNS": "80",
        "LC_ALL": "C.UTF-8",
        "NO_COLOR": "1",
        "PYTEST_ADDOPTS": BLOCKED,
    }


_WHO = {"NAME": "Reader", "EMAIL": "reader@example.org", "DATE": "2026-01-05T09:00:00Z"}


class Ran(NamedTuple):
    """A command that was run: its block, the command as on the page, its output, and its duration in s."""

    block: Block
    command: Command
    printed: str
    seconds: float


def run(page: str, folder: Path, *, nightly: bool = False) -> Iterator[Ran]:
    """Write a page's files and run its commands in an empty folder, in order."""
    with Shell(folder) as shell:
        for block in blocks(page):
            if block.file is not None:
                (shell.folder() / block.file).write_text(block.text, "utf-8")
            elif nightly or not block.nightly:
                for command in block.commands():
                    begun = time.perf_counter()
                    printed = shell.run(command.line)
                    yield Ran(block, command, printed, time.perf_counter() - begun)


def renewed(page: str, ran: list[Ran]) -> str:
    """Return a page with each differing output replaced by the printed one."""
    texts: dict[Block, str] = {}
    for one in ran:
        output = one.command.output
        if not same(output, one.printed):
            output = shortened(output, one.printed)
        texts[one.block] = texts.get(one.block, "") + f"$ {one.command.line}\n{output}"
    for block, text in reversed(texts.items()):
        page = page[: block.start] + text + page[block.end :]
    return page
