from __future__ import annotations

import importlib.util
import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from tests.slow import slow

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
SLOW = [
    "argparse",
    "base64",
    "cmd",
    "colorsys",
    "configparser",
    "difflib",
    "enum",
    "fnmatch",
    "functools",
    "gettext",
    "glob",
    "graphlib",
    "heapq",
    "html",
    "inspect",
    "ipaddress",
    "json",
    "operator",
    "optparse",
    "pathlib",
    "pprint",
    "queue",
    "quopri",
    "random",
    "reprlib",
    "sched",
    "statistics",
    "tempfile",
    "typing",
    "uuid",
]
SCRIPT = Path(__file__).with_name("law_of_stdlib.py")
needs_tests = pytest.mark.skipif(
    importlib.util.find_spec("test.test_textwrap") is None, reason="CPython's own tests are not installed"
)


def assert_lawful(*modules: str) -> None:
    """Run CPython's own tests of modules, unmodified and recorded: the same tests fail and are skipped."""
    done = subprocess.run(
        [sys.executable, str(SCRIPT), *modules], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    results = json.loads(done.stdout.splitlines()[-1])
    assert list(results) == list(modules)
    for module, (plain, recorded, sites, events) in results.items():
        assert recorded == plain, module
        assert plain[0] > 0, module
        assert events > sites, module


@slow
@needs_tests
def test_fully_recorded_standard_library_passes_its_tests():
    assert_lawful(*MODULES)


@needs_tests
@pytest.mark.skipif(not os.environ.get("TARL_SLOW"), reason="takes minutes; set TARL_SLOW=1")
@pytest.mark.parametrize("module", SLOW)
def test_more_modules_of_the_standard_library_pass_their_tests(module):
    assert_lawful(module)
