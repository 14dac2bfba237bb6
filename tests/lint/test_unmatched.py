"""Names in the settings that no file mentions are reported in every format."""

import subprocess
import sys

import pytest

from tarl_lint.report import FORMATS
from tarl_lint.settings.config import Config
from tarl_lint.settings.unmatched import unmatched
from tarl_lint.settings.wrappers import Wrapper

SAID = "pyproject.toml: 'sources' names 'robot.nothing', which no file mentions: check the name."


@pytest.mark.parametrize(
    ("text", "met"),
    [
        ("from robot.bus import listen\nlisten('a')", True),
        ("import robot.bus\nrobot.bus.listen('a')", True),
        ("def listen(topic): ...", True),
        ("class listen: ...", True),
        ("listen = make()", True),
        ("from other import listen\nlisten('a')", False),
        ("import robot.bus\nrobot.bus.listens('a')", False),
        ("", False),
    ],
)
def test_settings_match_a_definition_or_a_qualified_use(text, met):
    assert bool(unmatched(Config(sources=("robot.bus.listen",)), [text])) is not met


def test_every_kind_of_name_in_the_settings_is_checked():
    config = Config(
        sources=("a.one",),
        sinks=("a.two",),
        sanitizers=("a.three",),
        wrappers=(Wrapper("a.four", "rospy.Subscriber"),),
    )
    assert [s.split("'")[1] for s in unmatched(config, ["import a"])] == [
        "sources",
        "sinks",
        "sanitizers",
        "wrappers",
    ]


@pytest.mark.parametrize("name", sorted(FORMATS))
def test_unmatched_names_are_reported_in_every_format(tmp_path, name):
    (tmp_path / "pyproject.toml").write_text('[tool.tarl-lint]\nsources = ["robot.nothing"]\n')
    (tmp_path / "node.py").write_text("import rospy\n")
    done = subprocess.run(
        [sys.executable, "-m", "tarl_lint", "--no-cache", "--format", name],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0
    assert SAID in done.stdout + done.stderr
