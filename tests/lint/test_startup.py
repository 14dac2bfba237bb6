"""A run of the linter imports few modules, and none of the plugin."""

import subprocess
import sys
from pathlib import Path

import pytest

HEAVY = ("numpy", "libcst", "rich", "astroid", "pytest", "greenlet", "msgspec", "tomllib", "difflib")


def python(directory: Path, program: str) -> str:
    done = subprocess.run(
        [sys.executable, "-c", program],
        cwd=directory,
        capture_output=True,
        text=True,
        check=False,
        timeout=60,
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


@pytest.fixture
def place(example, in_directory) -> Path:
    return in_directory({"node.py": example.text, "clean.py": "import rospy\n\n\ndef f(x):\n    return x\n"})


def test_run_on_a_clean_file_imports_no_heavy_modules(place):
    program = f"""
import sys
from tarl_lint.cli import main
assert main(["clean.py"]) == 0
print(sorted(set({HEAVY!r}) & set(sys.modules)), file=sys.stdout)
"""
    assert python(place, program).splitlines()[-1] == "[]"


def test_the_linter_runs_without_the_other_dependencies(place):
    program = """
import sys

class Missing:
    def find_spec(self, name, path=None, target=None):
        if name.split(".")[0] in {"numpy", "pytest", "_pytest", "greenlet", "libcst", "rich", "msgspec", "astroid"}:
            raise ModuleNotFoundError(name)

sys.meta_path.insert(0, Missing())
import os
os.environ["FORCE_COLOR"] = "1"
from tarl_lint.cli import main
assert main(["node.py"]) == 1
assert main(["--format", "json", "--write-baseline"]) == 0
assert main([]) == 0
"""
    out = python(place, program)
    assert out.startswith("node.py:18:9 publishes progress")
    assert "\x1b" not in out


def test_file_without_endpoints_needs_no_analysis(place):
    program = """
import sys
from tarl_lint.cli import main
assert main(["clean.py"]) == 0
parts = ("tarl_lint.interpret", "tarl_lint.memory", "tarl_lint.models", "tarl_lint.engine")
print(sorted(name for name in sys.modules if name.startswith(parts)))
assert main(["node.py"]) == 1
print("tarl_lint.engine" in sys.modules)
"""
    out = python(place, program).splitlines()
    assert out[1] == "[]"
    assert out[-1] == "True"


@pytest.mark.parametrize("name", ["sarif", "gitlab", "junit", "github", "dot", "mermaid", "json"])
def test_no_report_format_imports_heavy_modules(place, name):
    program = f"""
import sys
from tarl_lint.cli import main
main(["node.py", "--format", {name!r}, "--output-file", "report"])
print(sorted(set({HEAVY!r}) & set(sys.modules)))
"""
    assert python(place, program).splitlines()[-1] == "[]"
