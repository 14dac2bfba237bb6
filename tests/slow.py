"""Slow tests run only with TARL_SLOW=1, each night, when the other tests draw new random cases."""

from __future__ import annotations

import os
import random
import secrets

import pytest

SLOW = os.environ.get("TARL_SLOW", "") not in ("", "0")

# With the seed 0, the random cases are the same in every run. TARL_SEED=… draws those of another run again; the
# variable also passes the seed on to the processes of xdist.
SEED = int(os.environ.setdefault("TARL_SEED", str(secrets.randbelow(2**32)) if SLOW else "0"))

slow = pytest.mark.skipif(not SLOW, reason="tens of seconds of CPU time: set TARL_SLOW=1")


def chance(key: int | str) -> random.Random:
    """Return the random generator of a test; `key` tells generators of one run apart."""
    return random.Random(f"{SEED} {key}" if SEED else key)
