"""Patches of many kinds of statements, nodes and files: both tools produce the simulated program, and it runs."""

from __future__ import annotations

import py_compile
import re
from dataclasses import dataclass
from pathlib import Path
from textwrap import indent

import pytest

from pytest_tarl.patching.mutate import Mutation
from pytest_tarl.patching.rewriting import rewrite
from tests.plugin.patching.repairs import MUD, TOPICS, HandMade, TinyRos, odometry, subscribing, terrain
from tests.plugin.patching.subscribed_nodes import NODES
from tests.plugin.patching.test_patch import patched, repository, run, shell

# statements that publish a value, with the results for an input of 1.0 as designed and in mud
FORMS = {
    "call": ("{publish}(5 * {value})", 5.0, 12.0),
    "condition": ("if 5 * {value} > 8.0:\n    {publish}(1.0)\nelse:\n    {publish}(0.0)", 0.0, 1.0),
    "elif": (
        "if {value} < 0.0:\n    pass\nelif 5 * {value} > 8.0:\n    {publish}(1.0)\nelse:\n    {publish}(0.0)",
        0.0,
        1.0,
    ),
    "return": ("def speed(by):\n    return 5 * by  # m/s\n\n{publish}(speed({value}))", 5.0, 12.0),
    "augmented": ("speed = 1.0\nspeed += 5 * {value}  # m/s\n{publish}(speed)", 6.0, 13.0),
    "comprehension": (
        "speeds = [5 * each for each in ({value}, {value})]\n{publish}(sum(speeds))",
        10.0,
        24.0,
    ),
    "loop": ("count = 0.0\nwhile 5 * {value} > count:\n    count += 4.0\n{publish}(count)", 8.0, 12.0),
}


@dataclass(frozen=True)
class Writing:
    """Encoding, line endings and indentation of a file."""

    ending: str = "\n"
    final: bool = True
    indentation: str = "    "
    encoding: str = "utf-8"
    remark: str = "Größe ½"

    def text(self, plain: str) -> str:
        lines = [re.sub("^( {4})+", self._indented, line) for line in plain.splitlines()]
        cookie = [] if self.encoding.startswith("utf-8") else [f"# -*- coding: {self.encoding} -*-"]
        start = 1 if lines[0].startswith("#!") else 0
        lines[start:start] = [*cookie, f"# {self.remark}"]
        return self.ending.join(lines) + (self.ending if self.final else "")

    def _indented(self, found: re.Match[str]) -> str:
        return self.indentation * (len(found[0]) // 4)


WRITINGS = {
    "LF": Writing(),
    "CRLF": Writing(ending="\r\n"),
    "no final newline": Writing(final=False),
    "CRLF, no final newline": Writing(ending="\r\n", final=False),
    "tabs": Writing(indentation="\t"),
    "a mark of UTF-8": Writing(encoding="utf-8-sig"),
    "latin-1": Writing(encoding="latin-1", ending="\r\n"),
    "koi8-r": Writing(encoding="koi8-r", remark="скорость", indentation="\t"),
    "shift_jis": Writing(
        encoding="shift_jis", remark="速度表", final=False
    ),  # one of its bytes is a backslash
}


def node(kind: str, form: str) -> str:
    """Return a node of this kind that executes the form's statements instead of publishing."""
    found = re.search(r"^( *)(.*)\.publish\(5 \* (.*)\)$", NODES[kind][0], re.MULTILINE)
    assert found is not None
    statements = FORMS[form][0].format(publish=f"{found[2]}.publish", value=found[3])
    return NODES[kind][0].replace(found[0], indent(statements, found[1]))


def repaired(kind: str, text: str) -> str:
    """Decode a file as Python does, analyse it, and change its constant 5 under the condition `mud`."""
    sources = {"node.py": text.replace("\r\n", "\n")}
    analysis = HandMade(sources, subscribing(sources, "node.py", *NODES[kind][2:]))
    return rewrite(analysis, [Mutation(analysis.operand("5", 5, "5 *"), 12.0)], MUD, TOPICS)["node.py"]


def published(text: str) -> list[float]:
    """Run a node before the terrain is known, in mud, and on firm ground again."""
    ros = TinyRos()
    space = ros.run({"node.py": text}, "node.py")
    for ground in (None, True, False):
        if ground is not None:
            ros.deliver("/terrain", terrain(ground))
        ros.deliver("/odom", odometry(1.0))
        if "step" in space:
            space["step"](space["pub"])
    return ros.published


@pytest.mark.parametrize("writing", WRITINGS)
@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize("kind", NODES)
def test_git_and_patch_produce_the_simulated_program(
    tmp_path: Path, kind: str, form: str, writing: str
) -> None:
    written = WRITINGS[writing]
    text = written.text(node(kind, form))
    simulated = repaired(kind, text)
    root = repository(tmp_path / "robot")
    file = root / "node.py"
    original = text.encode(written.encoding)
    file.write_bytes(original)
    patch = patched(root, {file: simulated})
    expected = simulated.replace("\r\n", "\n").replace("\n", written.ending).encode(written.encoding)
    run("git", "apply", str(patch), cwd=root)
    assert file.read_bytes() == expected
    file.write_bytes(original)
    shell(f"patch -s -p1 < {patch}", root)
    assert file.read_bytes() == expected
    assert written.remark in file.read_text(written.encoding)
    py_compile.compile(str(file), str(tmp_path / "node.pyc"), doraise=True)
    designed, muddy = FORMS[form][1:]
    assert published(file.read_text(written.encoding)) == [designed, muddy, designed]
