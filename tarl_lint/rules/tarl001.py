"""TARL001: a file cannot be analysed.

The file is not valid Python 3, cannot be decoded, or is nested too deeply. Python 2 files are named as such.
The other files are analysed as if this one did not exist, so flows through it are missed: repair the file,
port it, or exclude it.
"""

from __future__ import annotations

from typing import Final

CODE: Final = "TARL001"
SUMMARY: Final = "file cannot be analysed"

VALID: Final = ("print('ready')",)
INVALID: Final = ("print 'ready'",)
