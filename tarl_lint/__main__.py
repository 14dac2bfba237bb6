"""`python -m tarl_lint` is `tarl-lint`."""

import sys

from tarl_lint.cli import main

if __name__ == "__main__":
    sys.exit(main())
