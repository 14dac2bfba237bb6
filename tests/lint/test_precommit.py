import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from tests.slow import SLOW

ROOT = Path(__file__).parents[2]
PRE_COMMIT = Path(sys.executable).with_name("pre-commit")

pytestmark = pytest.mark.skipif(not PRE_COMMIT.exists(), reason="pre-commit is not installed")


def call(*command: object, cwd: Path, **environment: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [str(c) for c in command], cwd=cwd, capture_output=True, text=True, check=False, timeout=300,
        env={**os.environ, **environment},
    )  # fmt: skip


def commit_everything(directory: Path) -> str:
    """Make a directory a git repository with one commit and return the hash of that commit."""
    for arguments in (["init", "-q"], ["add", "-A"], ["commit", "-q", "-m", "All"]):
        identity = (
            "-c",
            "user.name=Tester",
            "-c",
            "user.email=tester@example.org",
            "-c",
            "commit.gpgsign=false",
        )
        done = call("git", *identity, *arguments, cwd=directory)
        assert done.returncode == 0, done.stderr
    return call("git", "rev-parse", "HEAD", cwd=directory).stdout.strip()


def copy_product(target: Path) -> None:
    """Copy the files that a commit of the current work tree would contain."""
    listed = call("git", "ls-files", "-co", "--exclude-standard", "-z", cwd=ROOT).stdout
    for name in filter(None, listed.split("\0")):
        if (ROOT / name).is_file():
            (target / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(ROOT / name, target / name)


def test_the_hook_definition_is_valid_for_pre_commit():
    done = call(PRE_COMMIT, "validate-manifest", ROOT / ".pre-commit-hooks.yaml", cwd=ROOT)
    assert (done.returncode, done.stdout + done.stderr) == (0, "")


@pytest.mark.skipif(not SLOW, reason="installs from PyPI, about 20 s: set TARL_SLOW=1")
def test_hook_stops_a_commit_with_a_new_flow(example, tmp_path):
    product, scratch = tmp_path / "product", tmp_path / "scratch"
    for directory in (product, scratch):
        directory.mkdir()
    copy_product(product)
    revision = commit_everything(product)
    (scratch / "node.py").write_text(example.text)
    (scratch / ".pre-commit-config.yaml").write_text(
        f"repos:\n- repo: {product}\n  rev: {revision}\n  hooks:\n  - id: tarl-lint\n"
    )
    commit_everything(scratch)
    home = {"PRE_COMMIT_HOME": str(tmp_path / "home")}

    installed = call(PRE_COMMIT, "install-hooks", cwd=scratch, **home)
    if installed.returncode:
        pytest.skip(f"the hook's environment cannot be installed here: {installed.stdout[-300:]}")

    stopped = call(PRE_COMMIT, "run", "--all-files", cwd=scratch, **home)
    assert stopped.returncode == 1
    assert "node.py:18:9 publishes progress (Float64) in travel" in stopped.stdout

    accepted = call(sys.executable, "-m", "tarl_lint", "--write-baseline", cwd=scratch)
    assert accepted.returncode == 0, accepted.stderr
    passed = call(PRE_COMMIT, "run", "--all-files", cwd=scratch, **home)
    assert passed.returncode == 0, passed.stdout

    second = example.text.replace(
        "        pub.publish(vel)\n", "        pub.publish(vel)\n        pub.publish(pos)\n"
    )
    (scratch / "node.py").write_text(second)
    stopped = call(PRE_COMMIT, "run", "--all-files", cwd=scratch, **home)
    assert stopped.returncode == 1
    assert "2 new flows in 1 file: 2 explicit.\n" in stopped.stdout
