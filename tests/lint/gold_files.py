"""Compare output with a file under tests/lint/gold.

`TARL_WRITE_GOLD=1 python -m pytest tests/lint/test_gold_flows.py tests/lint/test_gold_reports.py` writes the files
again after an intended change; review their diff like code.
"""

from __future__ import annotations

import os
from pathlib import Path

GOLD = Path(__file__).parent / "gold"
WRITES = os.environ.get("TARL_WRITE_GOLD", "") not in ("", "0")


def expected(name: str, text: str) -> list[str]:
    """Return the lines of a file in which the output is recorded; write it first if asked to."""
    file = GOLD / name
    if WRITES:
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text, encoding="utf-8")
    return file.read_text(encoding="utf-8").splitlines()
