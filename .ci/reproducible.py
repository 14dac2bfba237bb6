"""Build the wheel and the sdist twice, in two folders at two times, and compare them byte by byte.

`python .ci/reproducible.py` needs build and hatchling. SOURCE_DATE_EPOCH is the time of the last commit, as in a
release.
"""

from __future__ import annotations

import hashlib
import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
LEFT_OUT = shutil.ignore_patterns(
    ".venv*", "__pycache__", ".tarl", "dist", "*.egg-info", ".*_cache", ".hypothesis"
)


def main() -> None:
    """Print the digests; exit with status 1 if they differ."""
    at = subprocess.run(
        ["git", "log", "-1", "--format=%ct"], cwd=ROOT, capture_output=True, text=True, check=True
    )
    with tempfile.TemporaryDirectory() as folder:
        one, other = (built(Path(folder) / name, at.stdout.strip()) for name in ("one", "another place"))
    for name, digest in one.items():
        print(f"{digest}  {name}" + ("" if other.get(name) == digest else f"  differs: {other.get(name)}"))
    sys.exit(one != other)


def built(folder: Path, epoch: str) -> dict[str, str]:
    """Copy the sources into a folder, build there, and return the digest of each built file."""
    shutil.copytree(ROOT, folder, ignore=LEFT_OUT)
    for path in sorted(folder.rglob("*.py"), reverse=folder.name == "one"):
        path.touch()  # both copies differ in the order and the times of their files
    settings = {**os.environ, "SOURCE_DATE_EPOCH": epoch}
    settings["TZ"], settings["PYTHONHASHSEED"] = ("UTC", "1") if folder.name == "one" else ("Asia/Tokyo", "2")
    command = [sys.executable, "-m", "build", "--no-isolation", "--outdir", str(folder / "dist"), str(folder)]
    done = subprocess.run(command, env=settings, capture_output=True, text=True)
    if done.returncode:
        sys.exit(f"{' '.join(command)}:\n{done.stdout[-2000:]}{done.stderr[-2000:]}")
    return {
        path.name: hashlib.sha256(path.read_bytes()).hexdigest()
        for path in sorted((folder / "dist").iterdir())
    }


if __name__ == "__main__":
    main()
