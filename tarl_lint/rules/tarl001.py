"""TARL001: a file cannot be analysed.

The file is not valid Python 3, cannot be decoded, or is nested too deeply. If the file is Python 2, the message says
so. tarl-lint analyses the other files, but misses flows through this one. Fix the file, port it to Python 3, or exclude
it.
"""

from __future__ import annotations

from typing import Final

CODE: Final = "TARL001"
SUMMARY: Final = "file cannot be analysed"

VALID: Final = ("print('ready')",)
INVALID: Final = ("print 'ready'",)
