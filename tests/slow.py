"""A mark for tests that take tens of seconds: they run with TARL_SLOW=1, each night."""

from __future__ import annotations

import os

import pytest

slow = pytest.mark.skipif(
    os.environ.get("TARL_SLOW", "") in ("", "0"), reason="tens of seconds of CPU time: set TARL_SLOW=1"
)
