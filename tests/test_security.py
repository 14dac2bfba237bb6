"""The promises of SECURITY.md, checked with an audit hook that records events of the interpreter."""

from __future__ import annotations

import ast
import json
import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from tests.plugin.tank import NODE, TEST
from tests.slow import slow

ROOT = Path(__file__).parent.parent
WATCH = """
import json, os, sys
seen = []
told = ("socket.connect", "socket.getaddrinfo", "pickle.find_class", "subprocess.Popen", "os.system", "os.exec")
def hook(event, args):
    if event in told:
        seen.append([event, repr(args)[:200]])
    elif event == "exec" and hasattr(args[0], "co_filename"):
        seen.append(["exec", os.path.abspath(args[0].co_filename)])
    elif event == "open" and isinstance(args[0], str) and isinstance(args[2], int):
        if args[2] & (os.O_WRONLY | os.O_RDWR | os.O_CREAT):
            seen.append(["write", os.path.abspath(args[0])])
sys.addaudithook(hook)
import atexit
descriptor = os.dup(2)
atexit.register(lambda: os.write(descriptor, ("\\nSEEN" + json.dumps(seen)).encode()))
import runpy
sys.argv = json.loads(sys.argv[1])
runpy.run_module(sys.argv[0], run_name="__main__", alter_sys=True)
"""
HOSTILE = """
import os, pathlib, subprocess
here = pathlib.Path(__file__).parent
(here / "ran").write_text("at import")
os.system("touch ran-too")
class Meta(type):
    def __new__(cls, *args):
        (here / "ran").touch()
        return super().__new__(cls, *args)
class A(metaclass=Meta):
    field: (here / "ran").touch() = None
@(lambda f: (here / "ran").touch() or f)
def decorated(x=(here / "ran").touch()): ...
f"{(here / 'ran').touch()}"
__import__("helper")
"""


def watched(folder: Path, module: str, *arguments: str) -> tuple[subprocess.CompletedProcess[str], list[Any]]:
    """Run a module under the audit hook and return the recorded events."""
    command = [sys.executable, "-c", WATCH, json.dumps([module, *arguments])]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    _, _, seen = done.stderr.rpartition("\nSEEN")
    assert seen, done.stderr
    return done, json.loads(seen)


def kinds(seen: list[Any], *events: str) -> list[Any]:
    return [one for one in seen if one[0] in events]


CONNECTIONS = ("socket.connect", "socket.getaddrinfo")


def test_the_audit_hook_detects_unpickling_and_execution(tmp_path: Path) -> None:
    (tmp_path / "bad.py").write_text(
        "import pickle, collections\npickle.loads(pickle.dumps(collections.OrderedDict))\n"
    )
    _, seen = watched(tmp_path, "bad")
    assert kinds(seen, "pickle.find_class")
    assert ["exec", str(tmp_path / "bad.py")] in seen


def test_linting_executes_no_linted_code(tmp_path: Path) -> None:
    project = tmp_path / "project"
    project.mkdir()
    for name in ("node.py", "helper.py", "conftest.py", "sitecustomize.py", "setup.py"):
        (project / name).write_text(HOSTILE + NODE)
    (project / "pyproject.toml").write_text('[project]\nname = "x"\n')
    before = {path.name for path in project.iterdir()}
    done, seen = watched(project, "tarl_lint", "--no-cache", ".")
    assert "/level" in done.stdout, done.stderr
    assert {path.name for path in project.iterdir()} == before
    assert not [one for one in kinds(seen, "exec") if one[1].startswith(str(project)) and "<" not in one[1]]
    assert not kinds(seen, "pickle.find_class", *CONNECTIONS, "os.system", "os.exec")
    assert not [one for one in kinds(seen, "subprocess.Popen") if "'git'" not in one[1]]


def test_no_module_uses_pickle_to_read_data() -> None:
    unsafe = re.compile(r"^(pickle|cPickle|shelve|dill|cloudpickle|joblib)$")
    for path in [*(ROOT / "pytest_tarl").rglob("*.py"), *(ROOT / "tarl_lint").rglob("*.py")]:
        for node in ast.walk(ast.parse(path.read_text("utf-8"))):
            names = [alias.name for alias in node.names] if isinstance(node, ast.Import) else []
            names += [node.module or ""] if isinstance(node, ast.ImportFrom) else []
            assert not [name for name in names if unsafe.match(name.partition(".")[0])], path
            if isinstance(node, ast.keyword) and node.arg == "allow_pickle":
                assert isinstance(node.value, ast.Constant), path
                assert node.value.value is False, path


@pytest.mark.parametrize("workers", [pytest.param("1", marks=slow), "2"])
def test_run_opens_no_connection_and_writes_only_in_its_folder(tmp_path: Path, workers: str) -> None:
    project = tmp_path / "project"
    project.mkdir()
    (project / "keeper.py").write_text(NODE)
    (project / "test_tank.py").write_text(TEST)
    (project / "pytest.ini").write_text("[pytest]\n")
    plain = ("-p", "no:cacheprovider", "-p", "no:randomly", "-p", "no:asyncio", "-p", "no:rerunfailures")
    before = {path.name: path.read_bytes() for path in project.iterdir()}
    for flags in (["--tarl-record"], ["--tarl-online", "--tarl-repair"]):
        done, seen = watched(
            project, "pytest", *plain, *flags, "--tarl-episodes=8", f"--tarl-workers={workers}"
        )
        assert "TARL" in done.stdout, done.stdout + done.stderr
        assert not kinds(seen, "pickle.find_class", *CONNECTIONS, "os.system")
        written = [Path(one[1]) for one in kinds(seen, "write")]
        beside = [
            path
            for path in written
            if path.is_relative_to(project)
            and not path.is_relative_to(project / ".tarl")
            and "__pycache__" not in path.parts
        ]
        assert not beside
    assert (project / ".tarl" / "utility").is_dir()
    after = {path.name: path.read_bytes() for path in project.iterdir() if path.is_file()}
    assert after == before


def test_each_promise_names_existing_tests() -> None:
    rows = [line for line in (ROOT / "SECURITY.md").read_text("utf-8").splitlines() if line.startswith("| ")][
        1:
    ]
    assert len(rows) == 7
    for row in rows:
        (*_, tests, _) = row.split("|")
        named = re.findall(r"`([^`]+)`", tests)
        file = ""
        for one in named:
            named_file, _, test = one.partition("::")
            file = named_file or file
            text = (ROOT / file).read_text("utf-8")
            assert not test or f"def {test}(" in text, one
