"""The command `ament_tarl_lint`: run tarl-lint, and write a result file where colcon looks for it."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path


def main(argv: Sequence[str] | None = None) -> int:
    """Lint paths (default: the working directory); return 0 if no finding is new, 1 for findings, 2 for errors.

    Options that this command does not define itself are passed to tarl-lint, such as `--fail-on implicit`.
    """
    parser = argparse.ArgumentParser(prog="ament_tarl_lint", description=main.__doc__, allow_abbrev=False)
    parser.add_argument("--xunit-file", type=Path, help="write the result there in JUnit's format, too")
    asked, others = parser.parse_known_args(sys.argv[1:] if argv is None else argv)
    try:
        from tarl_lint.cli import main as lint
    except ImportError:
        print(
            "ament_tarl_lint: tarl is not installed for this Python: run pip install tarl.", file=sys.stderr
        )
        return 2
    if asked.xunit_file is not None:
        asked.xunit_file.parent.mkdir(parents=True, exist_ok=True)
        written = lint([*others, "--format", "junit", "--output-file", str(asked.xunit_file)])
        if written not in (0, 1):
            return written
    return lint(others)


if __name__ == "__main__":
    sys.exit(main())
