"""Programs that share modules are analysed separately, unless a flow may begin or end in a shared module."""

from __future__ import annotations

from pathlib import Path

import pytest

from tarl_lint.editing import Workspace
from tarl_lint.prefilter.by_words import groups
from tarl_lint.read.source import Script
from tarl_lint.run import groups as run_groups
from tarl_lint.settings.config import Config

NODE = """
import rospy
from std_msgs.msg import Float64
from helper import scaled

class Node:
    def __init__(self):
        self.pub = rospy.Publisher("/out", Float64)
        rospy.Subscriber("/in", Float64, self.receive)

    def receive(self, message):
        self.pub.publish(scaled(message.data))

if __name__ == "__main__":
    Node()
    rospy.spin()
"""
HELPER = "def scaled(value):\n    return 2 * value\n"


def grouped(files: dict[str, str]) -> list[set[str]]:
    scripts = [Script(f"{name}.py", name, text) for name, text in files.items()]
    return sorted(({script.name for script in group} for group in groups(scripts, Config())), key=sorted)


def test_programs_that_share_only_a_helper_are_analysed_separately():
    assert grouped({"one": NODE, "two": NODE, "helper": HELPER}) == [{"helper", "one"}, {"helper", "two"}]


@pytest.mark.parametrize(
    "change",
    [
        {"helper": HELPER + 'import rospy\nrospy.Subscriber("/a", int, print)\n'},
        {"two": NODE.replace('if __name__ == "__main__":', "if True:")},
        {"two": NODE + '\n__import__("one")\n'},
        {"helper": HELPER + 'import importlib\nimportlib.import_module("one")\n'},
    ],
    ids=["subscribes in the helper", "no program", "loads by name", "helper loads by name"],
)
def test_programs_that_can_exchange_data_are_analysed_together(change):
    assert grouped({"one": NODE, "two": NODE, "helper": HELPER} | change) == [{"helper", "one", "two"}]


def test_module_name_in_a_comment_is_no_import():
    files = {"one": NODE, "two": NODE, "helper": "# no importlib here\n" + HELPER}
    assert len(grouped(files)) == 2


def test_imported_program_is_analysed_with_its_importer():
    test = "import one\nif __name__ == '__main__':\n    one.Node()\n"
    assert grouped({"one": NODE, "test_one": test, "helper": HELPER}) == [{"helper", "one", "test_one"}]


def test_unimported_import_cycle_stays_in_one_group():
    files = {"one": NODE + "import two\n", "two": NODE + "import one\n", "helper": HELPER}
    assert grouped(files) == [{"helper", "one", "two"}]


def test_edit_reruns_only_programs_that_read_the_file(tmp_path, monkeypatch):
    for name, text in {"one": NODE, "two": NODE, "helper": HELPER}.items():
        Path(tmp_path, f"{name}.py").write_text(text)
    monkeypatch.chdir(tmp_path)
    analysed: list[str] = []
    perform = run_groups.perform

    def noted(task, config, *parsed):
        analysed.append(task.scripts[-1].path)
        return perform(task, config, *parsed)

    monkeypatch.setattr(run_groups, "perform", noted)
    workspace = Workspace([tmp_path])
    first = workspace.lint({})
    assert (sorted(analysed), len(first.findings)) == (["one.py", "two.py"], 2)
    analysed.clear()
    edited = NODE.replace("2", "3") + "EDITED = 1\n"
    assert len(workspace.lint({tmp_path / "one.py": edited}).findings) == 2
    assert analysed == ["one.py"]
    analysed.clear()
    workspace.lint({tmp_path / "helper.py": "def scaled(value):\n    return 1\n"})
    assert sorted(analysed) == ["one.py", "two.py"]


def test_an_error_in_a_shared_helper_is_reported_once(tmp_path, monkeypatch):
    for name, text in {"one": NODE, "two": NODE, "helper": HELPER + "def broken(:\n"}.items():
        Path(tmp_path, f"{name}.py").write_text(text)
    monkeypatch.chdir(tmp_path)
    assert [error.path for error in Workspace([tmp_path]).lint({}).errors] == ["helper.py"]
