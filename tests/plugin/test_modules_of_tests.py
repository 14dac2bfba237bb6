"""Edits of the test's world, reward or helpers are reported; edits of comments, drifts and other tests are not."""

from __future__ import annotations

from pathlib import Path

import pytest

from pytest_tarl.modules_of_tests import changes, digests
from tests.plugin.tank import ONLINE, RECORD, changed

WORLD = """\
class World:
    '''A tank.'''

    SIZE = 1.0

    def reward(self, level):
        return -abs(self.SIZE - level)

    def leak(self):
        return 0.0
"""


@pytest.fixture
def project(tmp_path: Path) -> Path:
    (tmp_path / "helpers").mkdir()
    (tmp_path / "helpers" / "__init__.py").write_text("from .deep import FACTOR\n")
    (tmp_path / "helpers" / "deep.py").write_text("FACTOR = 2\n")
    (tmp_path / "world.py").write_text(WORLD)
    (tmp_path / "node.py").write_text("x = 1\n")
    (tmp_path / "conftest.py").write_text("")
    (tmp_path / "test_it.py").write_text(
        "import pytest\nfrom world import World\nimport node\nDRIFTS = {'mud': 1}\nLIMIT = 3\n\n\n"
        "@pytest.mark.tarl(nodes=['node.py'], drifts=DRIFTS)\ndef test_it(tarl):\n    import helpers\n"
        "    assert LIMIT\n\n\ndef test_other():\n    pass\n"
    )
    return tmp_path


def told(project: Path, name: str, old: str, new: str) -> list[str]:
    """Return the changes that are reported for an edit."""
    before = digests("test_it.py::test_it[mud]", project, [project / "node.py"])
    path = project / name
    assert old in path.read_text()
    path.write_text(path.read_text().replace(old, new))
    return list(changes(before, digests("test_it.py::test_it", project, [project / "node.py"])))


@pytest.mark.parametrize(
    ("name", "old", "new", "expected"),
    [
        ("world.py", "-abs(self.SIZE", "-2 * abs(self.SIZE", ["world.py (World.reward)"]),
        ("world.py", "SIZE = 1.0", "SIZE = 2.0", ["world.py (World)"]),
        ("world.py", "'''A tank.'''", "# a tank", []),
        ("helpers/deep.py", "2", "3", ["helpers/deep.py (FACTOR)"]),
        ("test_it.py", "LIMIT = 3", "LIMIT = 4", ["test_it.py (LIMIT)"]),
        ("test_it.py", "assert LIMIT", "assert not LIMIT", ["test_it.py (test_it)"]),
        ("test_it.py", "{'mud': 1}", "{'mud': 1, 'ice': 2}", []),
        ("test_it.py", "drifts=DRIFTS", "drifts={}", []),
        ("test_it.py", "    pass", "    assert True", []),
        (
            "test_it.py",
            "    import helpers\n",
            "",
            ["helpers/__init__.py is gone", "helpers/deep.py is gone"],
        ),
        ("node.py", "x = 1", "x = 2", []),
    ],
)
def test_edits_are_reported_by_file_and_definition(
    project: Path, name: str, old: str, new: str, expected: list[str]
) -> None:
    found = [
        one
        for one in told(project, name, old, new)
        if not one.startswith("test_it.py") or "import" not in old
    ]
    assert found == expected


def test_a_file_that_cannot_be_parsed_is_ignored(project: Path) -> None:
    assert told(project, "world.py", "class World:", "class World") == ["world.py is gone"]


def test_older_recordings_have_no_test_data(project: Path) -> None:
    assert list(changes({}, digests("test_it.py::test_it", project, []))) == []


def test_an_edited_reward_is_reported_with_the_verdict(tank: pytest.Pytester) -> None:
    tank.runpytest(*RECORD)
    tank.runpytest(*ONLINE).stdout.no_fnmatch_line("*was edited since the recording*")
    changed(tank, "test_tank", "tarl.reward(-abs(1.0 - level))", "tarl.reward(-2 * abs(1.0 - level))")
    tank.runpytest(*ONLINE).stdout.fnmatch_lines(
        ["*note*the test itself was edited since the recording*", "*test_fills*Differences*"]
    )
