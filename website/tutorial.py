"""Run the commands on a page, and compare their output with the page or update it.

    python -m website.tutorial [--write] [PAGE]

If the tutorial's output has changed, `--write` also redraws the recording of the terminal.
"""

from __future__ import annotations

import argparse
import shlex
import sys
import tempfile
from pathlib import Path

from website.page_commands import TUTORIAL, renewed, run, same
from website.terminal import draw


def main() -> int:
    """Run a page's commands; return 1 if an output differs and the page was not updated."""
    parser = argparse.ArgumentParser(description="Run the commands of a page and compare their output.")
    parser.add_argument("page", nargs="?", type=Path, default=TUTORIAL)
    parser.add_argument("--write", action="store_true", help="update the page with the printed output")
    arguments = parser.parse_args()
    page = arguments.page.read_text("utf-8")
    with tempfile.TemporaryDirectory() as folder:
        ran = list(run(page, Path(folder).resolve()))
    other = [one for one in ran if not same(one.command.output, one.printed)]
    for one in other:
        print(f"$ {one.command.line}\n{one.printed}", end="")
    if arguments.write:
        arguments.page.write_text(renewed(page, ran), "utf-8")
        if other and arguments.page.resolve() == TUTORIAL:
            draw(ran)
    print(
        f"{shlex.quote(str(arguments.page))}: {len(ran)} commands, {len(other)} with outputs that differ from the page"
    )
    return int(bool(other) and not arguments.write)


if __name__ == "__main__":
    sys.exit(main())
