"""Fetch the site's fonts, Mermaid and search shim, so that reading the site needs no network.

npm fetches each package once; its digest is checked, and only the files named here are stored in `build/assets`. Later
builds find them there and need no network.
"""

from __future__ import annotations

import base64
import hashlib
import io
import shutil
import subprocess
import tarfile
import tempfile
from pathlib import Path
from typing import NamedTuple

KEPT = Path(__file__).parent.parent / "build" / "assets"


class AssetsError(Exception):
    """A package cannot be fetched, or its digest is not the pinned one."""


class Package(NamedTuple):
    """A pinned npm package: the tarball's sha512 digest, and the files to store (path in the tarball → new name)."""

    name: str
    version: str
    sha512: str
    files: dict[str, str]

    @property
    def stamp(self) -> Path:
        """Return the path of the empty file that marks this version as stored."""
        return KEPT / f".{self.name.replace('/', '-')}-{self.version}"


def _font(name: str) -> dict[str, str]:
    ranges = ("latin", "latin-ext", "greek")
    kept = {f"files/{name}-{one}-wght-normal.woff2": f"fonts/{name}-{one}.woff2" for one in ranges}
    return {**kept, "LICENSE": f"fonts/{name}-LICENSE.txt"}


SHIPPED = (
    Package(
        "mermaid",
        "12.3.0",
        "4113TdXeLAsMruJ79OpFL5O8+LTFXhQqZ260rF3tgUmiNAtRm4Uume04I+65PRN6yZ69J4f8rVYWW8zRk65UYw==",
        {"dist/mermaid.min.js": "mermaid.min.js", "LICENSE": "mermaid-LICENSE.txt"},
    ),
    Package(
        "iframe-worker",
        "1.0.4",
        "roeaaI+Lg1LJNfgpCjoRe/+WzEjy9+Z08LoEvu85MCPbBjwm+qXz8Ag5U05lHa6V1CysZyGzE0SOkAtSUA5q7Q==",
        {"shim/index.js": "iframe-worker.js", "LICENSE": "iframe-worker-LICENSE.txt"},
    ),
    Package(
        "@fontsource-variable/inter",
        "5.3.0",
        "OupL48va4JNofb97w6NYeF9S7W/kHNKM0Er8Dem5nqi4jeOLrVJDoE8tZEpnMJmtkvNbB1EIPPwHcdkF6b1oUA==",
        _font("inter"),
    ),
    Package(
        "@fontsource-variable/jetbrains-mono",
        "5.3.0",
        "F32xpS2NsGYoQi2ADSkKTgpJj7ozajsGgDJ8woTnqjmIB+dxDIqImjl4pXZVEExu8UFZ2ndhmX18EBS/hdz3Lw==",
        _font("jetbrains-mono"),
    ),
)
TESTED_WITH = Package(
    "axe-core",
    "4.14.1",
    "FHfa+lmNjQZfJz1q8wKqIDwC6DExcHt/pkjNQb09a3NPjCKg2rhu5qb2S4r76ASyFNNtuFooJpZe37OgudVGtQ==",
    {"axe.min.js": "axe/axe.min.js", "LICENSE": "axe/LICENSE.txt"},
)


def fetch(package: Package) -> None:
    """Store a package's files in `build/assets`, unless they are already there. Raise AssetsError on failure."""
    if package.stamp.exists():
        return
    npm = shutil.which("npm")
    if npm is None:
        raise AssetsError("npm is not installed: install it, since the fonts and Mermaid are npm packages.")
    with tempfile.TemporaryDirectory() as folder:
        spec = f"{package.name}@{package.version}"
        packed = subprocess.run(
            [npm, "pack", spec, "--silent", "--ignore-scripts"],
            cwd=folder,
            capture_output=True,
            text=True,
            check=False,
        )
        if packed.returncode:
            raise AssetsError(f"npm pack {spec}: {packed.stderr.strip().splitlines()[-1:]}")
        (tarball,) = Path(folder).glob("*.tgz")
        content = tarball.read_bytes()
    unpack(package, content)
    package.stamp.touch()


def unpack(package: Package, tarball: bytes) -> None:
    """Write the files to store from a tarball. Raise AssetsError if its digest is not the pinned one."""
    digest = base64.b64encode(hashlib.sha512(tarball).digest()).decode()
    if digest != package.sha512:
        raise AssetsError(
            f"{package.name} {package.version}: the digest of the tarball is not the pinned one."
        )
    with tarfile.open(fileobj=io.BytesIO(tarball)) as archive:
        for source, name in package.files.items():
            file = archive.extractfile(f"package/{source}")
            assert file is not None
            target = KEPT / name
            target.parent.mkdir(parents=True, exist_ok=True)
            target.write_bytes(file.read())


def available(package: Package) -> bool:
    """Return whether a package is already stored."""
    return package.stamp.exists()
