from __future__ import annotations

import importlib.util
import json
import subprocess
import sys
from pathlib import Path

import pytest

MODULES = [
    "textwrap",
    "fractions",
    "bisect",
    "csv",
    "calendar",
    "dataclasses",
    "string",
    "shlex",
    "copy",
    "contextlib",
]


@pytest.mark.skipif(
    importlib.util.find_spec("test.test_textwrap") is None, reason="CPython's own tests are not installed"
)
def test_the_standard_library_passes_its_own_tests_with_every_statement_recorded():
    script = Path(__file__).with_name("law_of_stdlib.py")
    done = subprocess.run(
        [sys.executable, str(script), *MODULES], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    results = json.loads(done.stdout.splitlines()[-1])
    assert list(results) == MODULES
    for module, (plain, recorded, sites, events) in results.items():
        assert recorded == plain, module
        assert plain[0] > 0, module
        assert events > sites, module
