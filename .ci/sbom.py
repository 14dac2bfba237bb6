"""Write the bill of materials of a release beside its wheel, in the form of CycloneDX 1.6.

`python .ci/sbom.py dist/tarl-0.1.0-py3-none-any.whl` lists the packages that the wheel needs, including those of its
extras for users. Their versions and digests come from requirements-dev.txt and requirements-simulators.txt. The same
wheel and lock files give the same bytes.
"""

from __future__ import annotations

import hashlib
import json
import re
import sys
import zipfile
from collections.abc import Iterator
from email.parser import Parser
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parent.parent
LOCKS = (ROOT / "requirements-dev.txt", ROOT / "requirements-simulators.txt")
DEVELOPMENT = {"dev", "bench"}  # extras that are not for users
_PINNED = re.compile(r"^([A-Za-z0-9._-]+)(?:\[[^]]*\])?==(\S+)(?: ; ([^\\]*?))? *\\?$")
_VIA = re.compile(r"^    #(?: via|  ) +(\S+)")


def main() -> None:
    """Write the file and print its path."""
    if len(sys.argv) != 2 or not sys.argv[1].endswith(".whl"):
        sys.exit("usage: python .ci/sbom.py dist/NAME.whl")
    wheel = Path(sys.argv[1])
    target = wheel.with_suffix(".cdx.json")
    target.write_text(json.dumps(bill(wheel, locked()), indent=2, sort_keys=True) + "\n")
    print(f"wrote {target}")


def locked() -> str:
    """Return the text of all lock files."""
    return "\n".join(lock.read_text() for lock in LOCKS)


def bill(wheel: Path, lock: str) -> dict[str, Any]:
    """Return the bill of materials of a wheel."""
    with zipfile.ZipFile(wheel) as archive:
        (metadata,) = (name for name in archive.namelist() if name.endswith(".dist-info/METADATA"))
        about = Parser().parsestr(archive.read(metadata).decode())
    pinned = merged(pins(lock))
    needed = closure({normal(name) for name in asked(about.get_all("Requires-Dist") or [])}, pinned)
    own = {
        "type": "library",
        "name": about["Name"],
        "version": about["Version"],
        "purl": f"pkg:pypi/{about['Name']}@{about['Version']}",
        "bom-ref": f"{about['Name']}@{about['Version']}",
        "licenses": [{"expression": about["License-Expression"]}],
        "hashes": [{"alg": "SHA-256", "content": hashlib.sha256(wheel.read_bytes()).hexdigest()}],
    }
    return {
        "bomFormat": "CycloneDX",
        "specVersion": "1.6",
        "version": 1,
        "metadata": {"component": own},
        "components": [component(one) for one in pinned if normal(one["name"]) in needed],
        "dependencies": [
            {
                "ref": own["bom-ref"],
                "dependsOn": sorted({ref(one) for one in pinned if normal(one["name"]) in needed}),
            }
        ],
    }


def asked(requirements: list[str]) -> Iterator[str]:
    """Yield the names that a wheel requires, except those of its extras for developers."""
    for line in requirements:
        extra = re.search(r"extra == ['\"]([\w-]+)", line)
        if extra is None or extra[1] not in DEVELOPMENT:
            yield re.split(r"[\[<>=!~; ]", line)[0]


def pins(lock: str) -> Iterator[dict[str, Any]]:
    """Yield the pins of a lock file: name, version, marker, digests, and which packages need it."""
    current: dict[str, Any] | None = None
    for line in lock.splitlines():
        if match := _PINNED.match(line):
            if current is not None:
                yield current
            current = {
                "name": match[1],
                "version": match[2],
                "marker": match[3] or "",
                "digests": [],
                "via": [],
            }
        elif current is not None and "--hash=sha256:" in line:
            current["digests"].append(line.partition("sha256:")[2].split()[0])
        elif current is not None and (via := _VIA.match(line)):
            current["via"].append(via[1])
    if current is not None:
        yield current


def merged(found: Iterator[dict[str, Any]]) -> list[dict[str, Any]]:
    """Merge equal pins of several lock files; a merged pin lists all packages that need it."""
    once: dict[tuple[str, str], dict[str, Any]] = {}
    for one in found:
        known = once.setdefault((normal(one["name"]), one["version"]), one)
        if known is not one:
            known["via"] += [via for via in one["via"] if via not in known["via"]]
    return list(once.values())


def closure(names: set[str], pinned: list[dict[str, Any]]) -> set[str]:
    """Return the names, and the names of all direct and indirect requirements."""
    found, before = set(names), set[str]()
    while found != before:
        before = set(found)
        found |= {normal(one["name"]) for one in pinned if {normal(via) for via in one["via"]} & found}
    return found


def component(one: dict[str, Any]) -> dict[str, Any]:
    """Return a pinned distribution as a component; the digests are those of its files on the index."""
    return {
        "type": "library",
        "name": one["name"],
        "version": one["version"],
        "purl": f"pkg:pypi/{normal(one['name'])}@{one['version']}",
        "bom-ref": ref(one),
        "hashes": [{"alg": "SHA-256", "content": digest} for digest in one["digests"]],
        **({"properties": [{"name": "python:marker", "value": one["marker"]}]} if one["marker"] else {}),
    }


def ref(one: dict[str, Any]) -> str:
    """Return the identifier of a component within the bill of materials."""
    return f"{normal(one['name'])}@{one['version']}"


def normal(name: str) -> str:
    """Return a package name in the normal form in which package indexes compare names."""
    return re.sub(r"[-_.]+", "-", name).lower()


if __name__ == "__main__":
    main()
