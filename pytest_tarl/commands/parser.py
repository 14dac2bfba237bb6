"""Parse the command line of `tarl`, with one-sentence error messages."""

from __future__ import annotations

import argparse
import difflib
import re
import sys
from collections.abc import Sequence
from typing import NoReturn

NO_COMMAND = "the following arguments are required: COMMAND"


class Parser(argparse.ArgumentParser):
    """The parser of `tarl` or of one of its commands.

    `passing` has the commands whose arguments after `--` are stored in `argv`.
    """

    passing: frozenset[str] = frozenset()

    def error(self, message: str) -> NoReturn:
        """Print the usage and a sentence, then exit with 2."""
        if message == NO_COMMAND:
            self.print_help(sys.stderr)
        else:
            self.print_usage(sys.stderr)
        self.exit(2, f"\n{self.prog}: {sentence(message)} Run {self.prog} --help for more.\n")

    def parse_args(self, args: Sequence[str] | None = None) -> argparse.Namespace:  # type: ignore[override]
        """Parse the arguments; errors show the usage of the command in question."""
        given = sys.argv[1:] if args is None else list(args)
        # argparse starts to fill `argv` at the first positional argument, and would reject options after it
        end = given.index("--") if given[:1] and given[0] in self.passing and "--" in given else len(given)
        found, extra = self.parse_known_args(given[:end])
        if end < len(given):
            found.argv += given[end + 1 :]
        if extra:
            command: Parser = getattr(found, "parser", self)
            command.error(f"unrecognized arguments: {' '.join(extra)}")
        return found


def sentence(message: str) -> str:
    """Return argparse's message as a sentence that says what to do."""
    if wrong := re.match(r"argument COMMAND: invalid choice: '(.*)' \(choose from (.*)\)$", message):
        known = re.findall(r"[\w-]+", wrong[2])
        close = difflib.get_close_matches(wrong[1], known, 1)
        return f"There is no command {wrong[1]!r}" + (f": did you mean {close[0]!r}?" if close else ".")
    if message == NO_COMMAND:
        return "Name one of the commands above, as in `tarl show .tarl/utility/NAME.npz`."
    if missing := re.match(r"the following arguments are required: (.*)$", message):
        *before, last = missing[1].split(", ")
        return f"{', '.join(before)} and {last} are missing." if before else f"{last} is missing."
    if extra := re.match(r"unrecognized arguments: (.*)$", message):
        return f"Unknown argument {extra[1]!r}."
    return f"{message[:1].upper()}{message[1:]}."
