"""Launch files that nest endlessly, include themselves or are not text give one sentence, never a traceback."""

from __future__ import annotations

import os
import re
import subprocess
import sys

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tarl_lint.cli import main
from tarl_lint.workspace.launch_read import read_launch
from tarl_lint.workspace.read import read

DEEP = 3_000
IMPORTS = "from launch import LaunchDescription\nfrom launch.actions import GroupAction\n"
GENERATE = "def generate_launch_description():\n    return LaunchDescription({})\n"
FILES = {
    "groups.launch": f"<launch>{'<group>' * DEEP}{'</group>' * DEEP}</launch>",
    "groups.launch.xml": f'<launch><let name="a" value="b"/>{"<group>" * DEEP}{"</group>" * DEEP}</launch>',
    "self.launch": '<launch><include file="$(find p)/launch/self.launch"/></launch>',
    "lists.launch.yaml": f"launch: {'[' * DEEP}{']' * DEEP}",
    "alias.launch.yaml": "launch: &a\n  - group: *a\n  - group: {x: *a}\n",
    "parameters.launch": '<launch><node pkg="p" type="n.py" name="n"><rosparam>' + "[" * DEEP + "]" * DEEP
    + '</rosparam><rosparam>&amp;a {b: *a}</rosparam><param name="x" type="yaml" value="&amp;a [*a]"/></node></launch>',
    "brackets.launch.py": f"def generate_launch_description():\n    return {'(' * DEEP}{')' * DEEP}\n",
    "list.launch.py": f"{IMPORTS}x = []\nx.append(x)\n{GENERATE.format('x')}",
    "group.launch.py": f"{IMPORTS}g = GroupAction([])\ng.add_action(g)\n{GENERATE.format('[g]')}",
    "recursion.launch.py": f"{IMPORTS}def f():\n    return f()\n{GENERATE.format('f()')}",
    "twice.launch.py": f"{IMPORTS}x = ['a']\nfor i in range(60):\n    x.extend(x)\n{GENERATE.format('x')}",
    "text.launch.py": f"{IMPORTS}x = 'a'\nfor i in range(60):\n    x = x + x\n{GENERATE.format('[]')}",
    "number.launch.py": f"{IMPORTS}x = 7\nfor i in range(60):\n    x = x * x\n{GENERATE.format('[]')}",
    "replace.launch.py": f"{IMPORTS}x = ('a' * 90000).replace('a', 'b' * 90000)\n{GENERATE.format('[]')}",
    "loops.launch.py": f"{IMPORTS}x = [0 for a in range(90000) for b in range(90000)]\n{GENERATE.format('[]')}",
    "shared.launch.py": f"{IMPORTS}x = ['a']\nfor i in range(60):\n    x = [x, x]\ny = 'b' in x, str(x)\n"
    + GENERATE.format("x"),
    "joined.launch.py": f"{IMPORTS}from launch.substitutions import *\nfrom launch_ros.actions import Node\nx = 'a'\n"
    "for i in range(40):\n    x = PathJoinSubstitution([x, x])\n" + GENERATE.format("[Node(executable='a', name=x)]"),
    "settings.launch.py": f"{IMPORTS}from launch_ros.actions import Node\nx = {{}}\nfor i in range(40):\n"
    "    x = {'a': x, 'b': x}\n" + GENERATE.format("[Node(executable='a', parameters=[x])]"),
    "break.launch.py": f"{IMPORTS}def generate_launch_description():\n    continue\n",
    "arguments.launch": "<launch><arg name='a0' default='ab'/>"
    + "".join(f"<arg name='a{i}' default='$(arg a{i - 1})$(arg a{i - 1})'/>" for i in range(1, 60))
    + "<node pkg='p' type='n.py' name='$(arg a59)'/></launch>",
    "bomb.launch": '<launch><node pkg="p" type="n.py" name="n"><rosparam>\nb0: &amp;b0 {x: 1}\n'
    + "".join(f"b{i}: &amp;b{i} {{a: *b{i - 1}, b: *b{i - 1}, c: *b{i - 1}}}\n" for i in range(1, 30))
    + "</rosparam></node></launch>",
    "nul.launch.py": "\0\0",
    "control.launch": "\x01\x02<launch>",
}  # fmt: skip


@pytest.fixture
def package(tmp_path, monkeypatch):
    (tmp_path / "launch").mkdir()
    (tmp_path / "package.xml").write_text("<package><name>p</name></package>")
    (tmp_path / "n.py").write_text("import rospy\nrospy.init_node('n')\n")
    (tmp_path / "n.py").chmod(0o755)
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.mark.parametrize("name", FILES)
def test_a_hostile_launch_file_ends_in_a_report(package, capsys, name):
    (package / "launch" / name).write_text(FILES[name])
    code = main(["--launch", f"launch/{name}"])
    out, err = capsys.readouterr()
    assert "Traceback" not in out + err
    if code == 2:
        assert re.fullmatch(rf"tarl-lint: launch/{name}(:\d+)?: the launch file cannot be read: .*\.\n", err)
        assert main(["--launch", "all"]) in (0, 1)
        assert "TARL001 The file cannot be read: " in capsys.readouterr().out
    elif name not in SILENT:
        assert "Not known here:" in out, out


SILENT = ("parameters.launch", "list.launch.py", "group.launch.py", "recursion.launch.py", "twice.launch.py",
          "text.launch.py", "number.launch.py", "replace.launch.py", "shared.launch.py")  # fmt: skip


PARTS = (
    *(
        "<group>",
        "</group>",
        "<node pkg='p' type='n.py' name='n'/>",
        "<launch>",
        "</launch>",
        "<include file='",
        "'/>",
    ),
    *(
        "if='$(",
        "$(arg x)",
        "$(eval (",
        "&a",
        "*a",
        "[",
        "]",
        "{",
        "}",
        ": ",
        "\n",
        "  ",
        "- node",
        "- group",
        "\0",
    ),
)


SPECIAL = (
    "p/setup.py", "p/setup.cfg", "p/CMakeLists.txt", "p/pyproject.toml", "p/scripts/run", "p/scripts/run.py",
    "p/launch/a.launch", "p/launch/b.launch.xml", "p/launch/c.launch.py", "p/launch/d.launch.yaml", "p/launch/e.xml",
    "p/config/f.yaml", "p/msg/G.msg", "p/src/h.cpp", "q/package.xml", "q/r.py", "pyproject.toml",
)  # fmt: skip


RUN = """
import sys
from pathlib import Path
from tarl_lint.cli import main
from tarl_lint.workspace.read import read

read(Path.cwd())
print(*(main(arguments) for arguments in (["."], *(["--launch", one] for one in sys.argv[1:]))))
"""


@pytest.mark.parametrize("kind", ["pipes", "devices"])
def test_pipes_and_devices_do_not_block(tmp_path, kind):
    for name in SPECIAL:
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        if kind == "pipes":
            os.mkfifo(tmp_path / name, 0o755)
        else:
            (tmp_path / name).symlink_to("/dev/zero")
    (tmp_path / "p" / "package.xml").write_text("<package><name>p</name></package>")
    (tmp_path / "plain.py").write_text("x = 1\n")
    launched = [name for name in SPECIAL if "/launch/" in name]
    done = subprocess.run(
        [sys.executable, "-c", RUN, "all", *launched],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        timeout=120,
    )
    assert "Traceback" not in done.stdout + done.stderr
    assert done.returncode == 0, done.stderr
    assert done.stdout.splitlines()[-1] == "0 0 2 2 2 2 2", done.stdout


@settings(max_examples=60, deadline=None)
@given(
    parts=st.lists(st.sampled_from(PARTS), max_size=30),
    suffix=st.sampled_from((".launch", ".launch.xml", ".launch.yaml", ".launch.py")),
)
def test_any_text_is_read_without_an_exception(tmp_path_factory, parts, suffix):
    folder = tmp_path_factory.mktemp("any")
    (folder / "package.xml").write_text("<package><name>p</name></package>")
    file = folder / f"any{suffix}"
    file.write_text("".join(parts))
    assert read_launch(file, read(folder)).file == file
