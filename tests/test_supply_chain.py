"""Requirements are pinned with digests, their licences are allowed, and releases are reproducible to the byte."""

from __future__ import annotations

import importlib.util
import json
import re
import subprocess
import sys
import zipfile
from importlib.metadata import PackageNotFoundError, metadata, requires
from pathlib import Path
from types import ModuleType

import pytest
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name
from packaging.version import Version

from tests.slow import SLOW

try:
    import tomllib
except ImportError:
    import tomli as tomllib

from pytest_tarl import extras

ROOT = Path(__file__).resolve().parent.parent
LOCKS = (ROOT / "requirements-dev.txt", ROOT / "requirements-simulators.txt")
ALLOWED = {
    *(
        "MIT",
        "MIT-0",
        "MIT-CMU",
        "BSD",
        "BSD-2-Clause",
        "BSD-3-Clause",
        "0BSD",
        "ISC",
        "Apache-2.0",
        "PSF-2.0",
        "Zlib",
        "CC0-1.0",
    ),
    *("MIT License", "BSD License", "Apache Software License", "ISC License (ISCL)", "DFSG approved"),
    *("Python Software Foundation License", "MPL-2.0", "Mozilla Public License 2.0 (MPL 2.0)"),
}
EXAMINED = {  # read by hand, because their declared licence is incomplete or too broad
    "apsw": "any OSI licence, so MIT",
    "docutils": "public domain; single files, which nothing here uses, are under the GPL; for twine only",
}


def load(name: str) -> ModuleType:
    spec = importlib.util.spec_from_file_location(name, ROOT / ".ci" / f"{name}.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def needed(extra: str) -> set[str]:
    """Return the distributions that an extra installs here, with their requirements in turn."""
    found: set[str] = set()
    seen: set[tuple[str, frozenset[str]]] = set()
    waiting = [Requirement(f"tarl[{extra}]")]
    while waiting:
        one = waiting.pop()
        try:
            lines = requires(one.name) or []
        except PackageNotFoundError:
            continue  # not installed: it is for another system
        found.add(canonicalize_name(one.name))
        for line in lines:
            inner = Requirement(line)
            asked = [{"extra": name} for name in one.extras] or [{"extra": ""}]
            here = inner.marker is None or any(inner.marker.evaluate(environment) for environment in asked)
            key = (canonicalize_name(inner.name), frozenset(inner.extras))
            if here and key not in seen:
                seen.add(key)
                waiting.append(inner)
    return found


def licences(name: str) -> set[str]:
    about = metadata(name)
    if expression := about.get("License-Expression"):
        return set(re.split(r" (?:AND|OR) |[()]", expression)) - {""}
    classified = [
        one.split(" :: ")[-1] for one in about.get_all("Classifier") or [] if one.startswith("License ::")
    ]
    named = classified or [(about.get("License") or "nothing").split("\n")[0]]
    return {part for one in named for part in one.split(" AND ")}


def test_every_licence_of_the_environment_is_allowed() -> None:
    names = needed("dev")
    assert {"numpy", "pytest", "libcst", "mypy", "scipy"} <= names
    others = {name: licences(name) - ALLOWED for name in names if name not in EXAMINED}
    assert {name: found for name, found in others.items() if found} == {}


def test_the_lock_pins_all_requirements_of_pyproject_with_digests() -> None:
    sbom = load("sbom")
    pinned: dict[str, list[dict[str, object]]] = {}
    for one in sbom.pins(sbom.locked()):
        assert one["digests"], f"{one['name']} has no digest"
        assert all(re.fullmatch("[0-9a-f]{64}", digest) for digest in one["digests"])
        pinned.setdefault(canonicalize_name(one["name"]), []).append(one)
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    asked = [
        *project["dependencies"],
        *(one for some in project["optional-dependencies"].values() for one in some),
    ]
    requirements = [Requirement(line) for line in asked if not line.startswith("tarl[")]
    assert len(requirements) > 20
    for wanted in requirements:
        found = pinned.get(canonicalize_name(wanted.name), [])
        assert found, f"{wanted.name} is in no lock: run .ci/lock.sh"
        for one in found:
            assert wanted.specifier.contains(Version(str(one["version"]))), f"{wanted}: run .ci/lock.sh"
    for lock in LOCKS:
        assert not re.search(r"https?://|file:", re.sub(r"^#.*$", "", lock.read_text(), flags=re.MULTILINE))


def test_bill_of_materials_is_reproducible(tmp_path: Path) -> None:
    wheel = tmp_path / "tarl-0.1.0-py3-none-any.whl"
    lines = [f"Requires-Dist: {one}" for one in requires("tarl") or ()]
    with zipfile.ZipFile(wheel, "w") as archive:
        head = ["Metadata-Version: 2.4", "Name: tarl", "Version: 0.1.0", "License-Expression: Apache-2.0"]
        archive.writestr("tarl-0.1.0.dist-info/METADATA", "\n".join([*head, *lines]) + "\n")
    sbom = load("sbom")
    bill = sbom.bill(wheel, sbom.locked())
    assert json.dumps(bill) == json.dumps(sbom.bill(wheel, sbom.locked()))
    names = {one["name"] for one in bill["components"]}
    assert {"numpy", "libcst", "greenlet", "pytest", "pluggy", "rosbags", "distributed", "toolz"} <= names
    assert not {"mypy", "ruff", "optuna"} & names
    assert (bill["bomFormat"], bill["specVersion"]) == ("CycloneDX", "1.6")
    refs = [one["bom-ref"] for one in bill["components"]]
    assert sorted(set(refs)) == bill["dependencies"][0]["dependsOn"]


@pytest.mark.skipif(not SLOW, reason="builds twice: set TARL_SLOW=1")
def test_a_release_is_reproducible_to_the_byte() -> None:
    done = subprocess.run([sys.executable, ".ci/reproducible.py"], cwd=ROOT, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
    assert re.search(r"^[0-9a-f]{64}  tarl-.*\.whl$", done.stdout, re.MULTILINE)


@pytest.mark.parametrize(
    ("enabled", "refused"), [(None, False), (lambda: True, False), (lambda: False, True)]
)
def test_free_threaded_python_is_reported(
    enabled: object, refused: bool, pytester: pytest.Pytester, monkeypatch: pytest.MonkeyPatch
) -> None:
    if enabled is None:
        monkeypatch.delattr(sys, "_is_gil_enabled", raising=False)
    else:
        monkeypatch.setattr(sys, "_is_gil_enabled", enabled, raising=False)
    assert (extras.no_lock("x") is not None) is refused
    if refused:
        pytester.makepyfile("def test_nothing(): pass")
        result = pytester.runpytest_inprocess("--tarl-record")
        result.stderr.fnmatch_lines(
            ["*needs the global interpreter lock, which is off in this Python: set PYTHON_GIL=1*"]
        )
        assert result.ret == pytest.ExitCode.USAGE_ERROR
        assert pytester.runpytest_inprocess().ret == 0
