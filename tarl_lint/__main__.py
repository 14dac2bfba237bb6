"""The entry point of the process `tarl-lint`, also used by `python -m tarl_lint`. It cannot import linted files."""

import sys

from tarl_lint import import_path


def main() -> int:
    """Run `tarl-lint` as a process of its own and return its exit code."""
    import_path.restrict()
    from tarl_lint.cli import main as run

    return run()


if __name__ == "__main__":
    sys.exit(main())
