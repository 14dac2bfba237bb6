"""The guide shows the output of `tarl fleet` for the example that `python -m website.fleet_example` writes."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import pytest

from tests.slow import slow
from website.pages import ROOT

pytest.importorskip("duckdb")

PAGE = ROOT / "docs" / "howto" / "fleet-logs.md"
SHOWN = re.compile(r"```console\n\$ (tarl fleet fleet --by site .*)\n(.*?)```", re.DOTALL)


@slow
def test_the_guide_shows_what_the_command_prints(tmp_path: Path) -> None:
    ((command, shown),) = SHOWN.findall(PAGE.read_text())
    example = tmp_path / "example"
    made = [sys.executable, "-m", "website.fleet_example", str(example)]
    subprocess.run(made, cwd=ROOT, check=True, capture_output=True)
    tarl = [sys.executable, "-m", "pytest_tarl", *command.split()[1:]]
    ran = subprocess.run(tarl, cwd=example, capture_output=True, text=True, check=False)
    assert ran.stdout.rstrip() == shown.rstrip()
