"""An editor session analyses a program again only after edits of something that its analysis has read."""

from __future__ import annotations

import ast
import random
from collections.abc import Iterator
from pathlib import Path

import pytest

from tarl_lint.editing import Result, Superseded, Workspace
from tarl_lint.prefilter.one_sided_groups import two_sided
from tarl_lint.read.moved_lines import moved_lines
from tarl_lint.read.source import Module
from tarl_lint.read.watched import Reading, watched
from tarl_lint.run import groups as run_groups
from tarl_lint.settings.config import Config
from tarl_lint.trees import walk

NODE = '''"""A node."""
import sys
import rospy
from std_msgs.msg import Float64
from helper import scaled, Filter


class Node:
    def __init__(self):
        self.filter = Filter(
            0.5,
        )
        self.pub = rospy.Publisher(sys.argv[1], Float64, queue_size=1)
        self.idle = rospy.Publisher("/idle", Float64, queue_size=1)
        rospy.Subscriber(sys.argv[2], Float64, self.receive)

    def receive(self, message):
        # smooth the value
        value = self.filter.next(message.data)
        if (value > 3 and
                value < 5
           ):
            self.pub.publish(scaled(value))

    def unused(self):
        return [1, 2]


if __name__ == "__main__":
    rospy.init_node("node")
    Node()
    rospy.spin()
'''
HELPER = '''def scaled(value):
    return 2 * value


def squared(value):
    """Return a square."""
    total = value * value
    return total


class Filter:
    def __init__(self, gain):
        self.gain, self.last = gain, 0.0

    def next(self, value):
        self.last += self.gain * (value - self.last)
        return self.last

    @property
    def state(self):
        return self.last

    @state.setter
    def state(self, value):
        self.last = value
'''


@pytest.fixture
def analysed(tmp_path, monkeypatch) -> list[str]:
    """Write the files, and list the programs that are analysed from now on."""
    Path(tmp_path, "node.py").write_text(NODE)
    Path(tmp_path, "helper.py").write_text(HELPER)
    monkeypatch.chdir(tmp_path)
    found: list[str] = []
    perform = run_groups.perform

    def noted(task, *rest):
        found.append(task.scripts[-1].path)
        return perform(task, *rest)

    monkeypatch.setattr(run_groups, "perform", noted)
    return found


def edited(tmp_path: Path, name: str, before: str, after: str) -> dict[Path, str]:
    """Return the unsaved text of a file after a replacement."""
    text = Path(tmp_path, name).read_text()
    assert text.count(before) == 1
    return {tmp_path / name: text.replace(before, after)}


LAYOUT = [
    ("node.py", "import sys", "# a comment\n\nimport sys"),
    ("node.py", "        # smooth the value\n", ""),
    ("node.py", "    def receive", "\n\n    def receive"),
    ("helper.py", "    return total", "    return total + 1"),
    ("helper.py", "    total = value * value\n", "    total = value\n    total *= total\n"),
    ("helper.py", '    """Return a square."""\n', ""),
]


@pytest.mark.parametrize(("name", "before", "after"), LAYOUT)
def test_edit_outside_analysed_code_only_moves_lines(tmp_path, analysed, name, before, after):
    workspace = Workspace([tmp_path])
    workspace.lint({})
    analysed.clear()
    buffers = edited(tmp_path, name, before, after)
    result = workspace.lint(buffers)
    assert analysed == []
    assert result == Workspace([tmp_path]).lint(buffers)
    assert result.findings


READ = [
    ("node.py", "value > 3", "value > 4"),
    ("node.py", "# smooth the value", "value = 1"),
    ("node.py", "                value < 5\n", "                value < 5\n                # a bound\n"),
    ("helper.py", "2 * value", "3 * value"),
    ("helper.py", "def squared(value)", "def squared(number)"),
    (
        "helper.py",
        "    return total",
        "    yield total",
    ),  # "yield" changes how the file's names are collected
    ("helper.py", "    return total", "    return total + idle"),  # may read the unused publisher
    ("helper.py", "class Filter:", "import os\n\nclass Filter:"),
    (
        "helper.py",
        "        self.last = value\n",
        "        self.last = 2 * value\n",
    ),  # two functions named state
]


@pytest.mark.parametrize(("name", "before", "after"), READ)
def test_an_edit_of_analysed_code_needs_a_new_analysis(tmp_path, analysed, name, before, after):
    workspace = Workspace([tmp_path])
    workspace.lint({})
    analysed.clear()
    buffers = edited(tmp_path, name, before, after)
    result = workspace.lint(buffers)
    assert analysed == ["node.py"]
    assert result == Workspace([tmp_path]).lint(buffers)


def test_each_edit_is_compared_with_the_last_analysis(tmp_path, analysed):
    workspace = Workspace([tmp_path])
    workspace.lint({})
    first = edited(tmp_path, "helper.py", "return total", "return total - 1")
    workspace.lint(first)
    broken = edited(tmp_path, "helper.py", "return total", "return total -")
    assert len(workspace.lint(broken).errors) == 1
    analysed.clear()
    second = edited(tmp_path, "helper.py", "return total", "value += 1\n    return total")
    result = workspace.lint(second)
    assert analysed == []
    assert result == Workspace([tmp_path]).lint(second)


def test_edit_can_be_compared_with_an_older_analysis(tmp_path, analysed):
    workspace = Workspace([tmp_path])
    workspace.lint({})
    for _ in range(3):
        workspace.lint({})
    analysed.clear()
    workspace.lint(edited(tmp_path, "node.py", "    def receive", "    # a comment\n    def receive"))
    assert analysed == []


def test_an_undone_edit_needs_no_analysis(tmp_path, analysed):
    workspace = Workspace([tmp_path])
    first = workspace.lint({})
    for value in range(4):
        workspace.lint(edited(tmp_path, "node.py", "value > 3", f"value > {value + 10}"))
    analysed.clear()
    assert workspace.lint({}) == first
    assert analysed == []


def test_edit_after_an_undo_is_compared_with_the_original(tmp_path, analysed):
    workspace = Workspace([tmp_path])
    workspace.lint({})
    workspace.lint(edited(tmp_path, "node.py", "value > 3", "value > 4"))
    workspace.lint({})
    analysed.clear()
    buffers = edited(tmp_path, "helper.py", "return total", "return total - 1")
    assert workspace.lint(buffers) == Workspace([tmp_path]).lint(buffers)
    assert analysed == ["node.py"]  # analysed by the new session


def test_edited_program_is_final_before_others_are_analysed(tmp_path, analysed):
    for number in range(4):
        Path(tmp_path, f"other{number}.py").write_text(NODE.replace("/idle", f"/idle{number}"))
    workspace = Workspace([tmp_path])
    workspace.lint({})
    analysed.clear()
    early: list[tuple[Result, frozenset[str], int]] = []
    buffers = edited(tmp_path, "helper.py", "2 * value", "3 * value")
    buffers |= edited(tmp_path, "other2.py", "value > 3", "value > 4")
    whole = workspace.lint(buffers, early=lambda *known: early.append((*known, len(analysed))))
    assert analysed[0] == "other2.py"
    assert [done for _, _, done in early] == [1, 2, 4]
    for result, settled, done in early:
        assert settled == set(analysed[:done])
        final = [f for f in whole.findings if f.span.path in settled]
        assert final
        assert [f for f in result.findings if f.span.path in settled] == final
    assert whole == Workspace([tmp_path]).lint(buffers)


def test_an_obsolete_run_stops_and_keeps_its_finished_analyses(tmp_path, analysed):
    Path(tmp_path, "other.py").write_text(NODE)
    workspace = Workspace([tmp_path])
    with pytest.raises(Superseded):
        workspace.lint({}, lambda: not analysed)
    assert len(analysed) == 1
    result = workspace.lint({})
    assert sorted(analysed) == ["node.py", "other.py"]
    assert result == Workspace([tmp_path]).lint({})


def edits(rng: random.Random, text: str) -> Iterator[str]:
    """Yield texts, each with one more edit at a random statement than the one before."""
    while True:
        lines = text.split("\n")
        places = [n for n in walk(ast.parse(text)) if isinstance(n, ast.stmt)]
        place = rng.choice(places)
        indent = " " * place.col_offset
        added = rng.choice(["# a comment", "", "pass", "fresh = 1", "# a \N{GREEK SMALL LETTER PI}", None])
        if added is None and lines[place.lineno - 1].strip().startswith("return "):
            lines[place.lineno - 1] += " or 0"
        elif added is not None:
            lines.insert(place.lineno - 1, indent + added if added else "")
        try:
            ast.parse("\n".join(lines))
        except SyntaxError:
            continue
        text = "\n".join(lines)
        yield text


@pytest.mark.parametrize("seed", range(3))
def test_random_edits_give_the_results_of_a_new_session(tmp_path, analysed, seed):
    rng = random.Random(seed)
    workspace = Workspace([tmp_path])
    workspace.lint({})
    files = {name: edits(rng, Path(tmp_path, name).read_text()) for name in ("node.py", "helper.py")}
    buffers: dict[Path, str] = {}
    reused = 0
    for _ in range(5):
        name = rng.choice(sorted(files))
        buffers[tmp_path / name] = next(files[name])
        analysed.clear()
        result = workspace.lint(buffers)
        reused += not analysed
        assert result == Workspace([tmp_path]).lint(buffers)
    assert reused


def module(text: str) -> Module:
    """Return a module with this text."""
    return Module("m.py", "m", text, ast.parse(text))


def test_reading_the_body_of_a_function_is_recorded():
    text = "def f():\n    def g():\n        pass\ndef h():\n    pass\nif f:\n    def k(): pass\n"
    observed = watched(module(text))
    places = {"f": (1, 0), "g": (2, 4), "h": (4, 0), "k": (7, 4)}
    assert observed.reading() == Reading(frozenset(places.values()), (), whole=False)
    assert len(observed.tree.body[0].body) == 1
    assert observed.reading().unread == {places["g"], places["h"], places["k"]}
    for _ in ast.walk(observed.tree):
        pass
    assert observed.reading().unread == set()
    assert watched(observed).reading().unread == set(places.values())


def test_queries_about_the_text_of_a_module_are_recorded():
    observed = watched(module("def f():\n    return 1\n"))
    assert observed.contains("return")
    assert not observed.contains("yield")
    reading = observed.reading()
    assert [known for _, known in reading.answers] == [True, False]
    assert not reading.whole
    assert moved_lines("def f():\n    return 1\n", "def f():\n    return 2\n", reading) == {1: 1}
    assert moved_lines("def f():\n    return 1\n", "def f():\n    yield 2\n", reading) is None
    assert observed.text
    assert observed.reading().whole
    assert moved_lines("def f():\n    return 1\n", "def f():\n    return 2\n", observed.reading()) is None


def test_group_is_analysed_if_its_text_has_certain_words():
    assert two_sided(["rospy.Subscriber(", "pub.publish(1)"], Config())
    assert not two_sided(["rospy.Subscriber(", "# pub.publish(1)"], Config())
