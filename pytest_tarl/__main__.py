"""Make `python -m pytest_tarl` work like the command `tarl`, for robots where `tarl` is not on the PATH."""

from __future__ import annotations

import sys

from pytest_tarl.commands.cli import main

if __name__ == "__main__":
    sys.exit(main())
