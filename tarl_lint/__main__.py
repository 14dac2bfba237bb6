"""The process `tarl-lint`, also as `python -m tarl_lint`: nothing of the linted files can be imported."""

import sys

from tarl_lint import import_path


def main() -> int:
    """Run `tarl-lint` as a process of its own and return its exit code."""
    import_path.restrict()
    from tarl_lint.cli import main as run

    return run()


if __name__ == "__main__":
    sys.exit(main())
