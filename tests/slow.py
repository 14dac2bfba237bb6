"""Tests that take tens of seconds run only with TARL_SLOW=1, each night."""

from __future__ import annotations

import os

import pytest

SLOW = os.environ.get("TARL_SLOW", "") not in ("", "0")

slow = pytest.mark.skipif(not SLOW, reason="tens of seconds of CPU time: set TARL_SLOW=1")
