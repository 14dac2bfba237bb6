"""On any files, nothing crashes or hangs, files that cannot be analysed are named, and the others are reported."""

from __future__ import annotations

import os
import sysconfig
from collections.abc import Callable
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from tarl_lint.cli import main
from tarl_lint.read.source import LARGEST, Script, read
from tarl_lint.run.groups import Task, perform
from tarl_lint.run.runner import Result, run
from tarl_lint.settings.config import Config, Options, resolve
from tests.slow import SLOW, chance

NODE = """\
import rospy
from std_msgs.msg import Float64
pub = rospy.Publisher("/out", Float64)
def callback(msg):
    x = {}
    pub.publish(x)
rospy.Subscriber("/in", Float64, callback)
"""
PLAIN = NODE.format("msg.data")

Lint = Callable[..., Result]


@pytest.fixture
def lint(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Lint:
    """Lint files beside a valid node, whose flow must always be reported."""
    monkeypatch.chdir(tmp_path)

    def go(files: dict[str, bytes | str], *, jobs: int = 1) -> Result:
        for name, data in {"good.py": PLAIN, **files}.items():
            Path(name).write_bytes(data if isinstance(data, bytes) else data.encode())
        return linted(jobs)

    return go


def linted(jobs: int = 1) -> Result:
    options = Options(cache=False, jobs=jobs)
    result = run(options, resolve(options))
    assert "good.py" in {f.span.path for f in result.findings}
    return result


def reasons(result: Result) -> dict[str, str]:
    assert not [error for error in result.errors if error.bug]
    return {error.path: error.message for error in result.errors}


@pytest.mark.parametrize(
    ("data", "reason"),
    [
        (b"# coding: klingon\nimport rospy\n", "Unknown encoding: unknown encoding: klingon."),
        (b"# coding: rot13\nimport rospy\n", "Unknown encoding: 'rot13' is not a text encoding"),
        (b"# coding: undefined\nimport rospy\n", "Unknown encoding: "),
        (b"# coding: ascii\n# \xf6\nimport rospy\n", "The bytes are not valid ascii: name the encoding"),
        ("import rospy\n# ö\n".encode("latin-1"), "The bytes are not valid utf-8: name the encoding"),
        ("import rospy\n".encode("utf-16"), "Unknown encoding: invalid or missing"),
        (b"# coding: utf-16\nimport rospy\n", "The file is not valid Python"),
        (b"# coding: utf-7\nimport rospy +AAA-\n", "The file contains a null byte"),
        (b"# coding: unicode_escape\nimport rospy \\ud800\n", "The file cannot be parsed"),
        (b"import rospy\n\0\n", "The file contains a null byte, so it is not Python source: exclude it."),
        (b"import rospy\ndef f(:\n", "The file is not valid Python (invalid syntax): fix this line, or exclude"),
        (b"import rospy\nprint 'x'\n", "This is Python 2, which is not analysed: port the file to Python 3."),
        (b"import rospy\nx = " + b"(" * 5_000 + b")" * 5_000, "too many nested parentheses"),
        (b"import rospy\nx = " + b"-" * 9_000 + b"1", "The code is nested too deeply to be parsed: split"),
        (b"import rospy\n" + b"x = 1\n" * (LARGEST // 6), "The file has more than 2 MB: move data out"),
    ],
)  # fmt: skip
def test_unanalysable_file_is_named_with_advice(lint, data, reason):
    assert reason in reasons(lint({"odd.py": data}))["odd.py"]


@pytest.mark.parametrize(
    "data",
    [
        b"",
        b"\n\n\n",
        b"#!/usr/bin/env python3",
        b"\xef\xbb\xbf" + PLAIN.encode(),
        PLAIN.replace("\n", "\r\n").encode(),
        PLAIN.replace("\n", "\r").encode(),
        PLAIN.replace("\n", "\n\f").encode(),
        PLAIN.rstrip("\n").encode(),
        b"# -*- coding: latin-1 -*-\n# gr\xf6\xdfe\n" + PLAIN.encode(),
        NODE.format("msg.data + '\\ud800'").encode(),
    ],
    ids=["empty", "blank", "shebang", "BOM", "CRLF", "CR", "form feeds", "no last line end", "latin-1", "surrogate"],
)  # fmt: skip
def test_an_unusual_but_valid_file_is_analysed(lint, data):
    result = lint({"odd.py": data})
    assert reasons(result) == {}
    assert ("odd.py" in {f.span.path for f in result.findings}) == (b"rospy" in data)


@pytest.mark.parametrize(
    "value",
    [
        "(" * 150 + "msg.data" + ")" * 150,
        "f(" * 90 + "msg.data" + ")" * 90,
        "[" * 90 + "msg.data" + "]" * 90,
        "-" * 400 + "msg.data",
        "not " * 400 + "msg.data",
        " + ".join(["msg.data"] * 800),
        " + ".join(["msg.data"] * 10_000),
        " < ".join(["msg.data"] * 2_000),
        "1 if msg.data else " * 500 + "0",
        "1 if msg.data else " * 2_000 + "0",
        "lambda: " * 500 + "msg.data",
        "msg" + ".a" * 800,
        "msg" + ".a" * 5_000,
        "msg" + "[0]" * 800,
        "msg" + ".f()" * 400,
        "[" + "msg.data," * 5_000 + "]",
        "{" + "msg.data: msg.data," * 2_000 + "}",
        "f'" + "{msg.data}" * 2_000 + "'",
        "[" * 30 + "msg.data" + " for i in y]" * 30,
        "msg.data\n    if x:" + "".join("\n" + " " * (i + 8) + "if x:" for i in range(80)) + "\n" + " " * 99 + "x = 1",
        "msg.data\n    if x == 0: x = 0\n" + "".join(f"    elif x == {i}: x = {i}\n" for i in range(200)),
        "msg.data\n" + "    x = x + 1\n" * 2_000,
        "msg.data  # " + "x" * 1_000_000,
    ],
    ids=range(23),
)  # fmt: skip
def test_deep_code_is_analysed_or_named(lint, value):
    result = lint({"odd.py": NODE.format(value)})
    assert set(reasons(result).values()) <= {
        "The code is nested too deeply to be parsed: split the expression, or exclude the file.",
        "The code is nested too deeply to be analysed: split the expression, or exclude the file.",
    }


@pytest.mark.parametrize("header", ["def f{}(msg):", "class C{}:", "for i{} in rospy:", "with rospy as c{}:"])
def test_deep_blocks_are_analysed_or_named(lint, header):
    text = (
        "import rospy\n" + "".join(" " * i + header.format(i) + "\n" for i in range(95)) + " " * 95 + "pass\n"
    )
    reasons(lint({"odd.py": text}))


def test_special_files_are_skipped_and_named_on_request(lint, tmp_path, capsys):
    Path("directory.py").mkdir()
    os.mkfifo("pipe.py")
    Path("device.py").symlink_to("/dev/zero")
    Path("circle").symlink_to("circle")
    Path("circle.py").symlink_to("circle.py")
    Path("here").symlink_to(".")
    Path("dangling.py").symlink_to("gone.py")
    assert reasons(lint({})) == {}
    for name in ("pipe.py", "device.py"):
        assert main([name, "--format", "concise"]) == 0
        assert f"{name}:1:1 TARL001 This is not a regular file: exclude it" in capsys.readouterr().out
    assert main(["dangling.py"]) == 2
    assert "dangling.py is a broken link to gone.py" in capsys.readouterr().err
    assert main(["circle"]) == 2
    assert "circle is a broken link to circle" in capsys.readouterr().err


def test_unreadable_files_and_directories_are_named(lint, monkeypatch, capsys):
    """Simulated, since the user who runs the tests may be root."""
    Path("closed").mkdir()
    Path("secret.py").write_text("x = 1\n")
    scandir, opened = os.scandir, Path.open

    def refuse(original):
        def go(path, *arguments, **options):
            if Path(path).name in ("closed", "secret.py"):
                raise PermissionError(13, "Permission denied", str(path))
            return original(path, *arguments, **options)

        return go

    monkeypatch.setattr(os, "scandir", refuse(scandir))
    monkeypatch.setattr(Path, "open", refuse(opened))
    result = lint({})
    assert reasons(result) == {
        "secret.py": "This file cannot be read: Permission denied. Make it readable, or exclude it."
    }
    assert result.statistics.notes.unreadable == ("closed",)


def test_control_characters_in_names_are_escaped(lint, capsys):
    names = [os.fsdecode(b"n\xf6de.py"), "größe \N{ROBOT FACE}.py", "new\nline.py", "esc\x1b[31m.py"]
    assert reasons(lint(dict.fromkeys(names, PLAIN))) == {}
    for form in ("text", "concise", "json", "sarif", "github", "gitlab", "junit", "dot", "mermaid"):
        assert main(["--format", form, "--no-cache"]) == 1
        out = capsys.readouterr().out
        assert "\x1b" not in out
    main(["--format", "concise", "--no-cache"])
    out = capsys.readouterr().out
    assert "new\\nline.py:6:5 TARL101" in out
    assert "esc\\x1b[31m.py:6:5 TARL101" in out
    assert main(["--write-baseline"]) == 0
    assert main([]) == 0


def test_control_characters_in_code_are_escaped(lint, capsys):
    lint({"odd.py": NODE.format("msg.data  # \x1b]0;owned\x07")})
    main(["odd.py"])
    assert "# \\x1b]0;owned\\x07" in capsys.readouterr().out


def test_many_small_files_are_linted_in_two_processes(lint):
    files = {
        f"n{i}.py": f"import n{i // 2}\n\ndef f(x):\n    return x + {i}\n"
        for i in range(5_000 if SLOW else 400)
    }
    one = lint(files)
    assert linted(jobs=2).findings == one.findings
    assert one.statistics.files == len(files) + 1


@given(st.binary(max_size=400))
@settings(max_examples=2_000 if SLOW else 100)
def test_random_bytes_are_read_or_refused(data):
    examined(b"import rospy\n" + data)
    examined(data + b"\nimport rospy\n")


@pytest.mark.parametrize("seed", range(3))
def test_damaged_programs_are_read_or_refused(seed):
    """A real node with bytes changed, removed and doubled."""
    chosen = chance(seed)
    for _ in range(200 if SLOW else 20):
        data = bytearray(PLAIN.encode())
        for _ in range(chosen.randint(1, 4)):
            at, length = chosen.randrange(len(data)), chosen.randint(0, 6)
            data[at : at + length] = chosen.choice(
                [b"", bytes(data[at : at + length]) * 2, b"(", b"\n  ", b"=", b"*"]
            )
        examined(bytes(data))


def test_generated_programs_are_analysed():
    hypothesmith = pytest.importorskip("hypothesmith")

    @given(hypothesmith.from_node(auto_target=False))
    @settings(
        max_examples=300 if SLOW else 4,
        suppress_health_check=list(HealthCheck),
    )
    def programs(text):
        examined(f"import rospy\n{text}\n".encode("utf-8", "surrogatepass"))
        body = "".join(f"    {line}\n" for line in text.splitlines())
        examined((PLAIN + f"def more(msg):\n{body}").encode("utf-8", "surrogatepass"))

    programs()


def standard_library() -> list[Path]:
    home = Path(sysconfig.get_path("stdlib"))
    every = sorted(p for p in home.rglob("*.py") if "site-packages" not in p.parts)
    return every if SLOW else chance(1).sample(every, 12)


def test_the_standard_library_is_analysed():
    """Each file is treated as part of a node; otherwise only its syntax would be checked."""
    for path in standard_library():
        examined(b"\n".join([path.read_bytes(), b"import rospy"]), str(path))


def examined(data: bytes, path: str = "odd.py") -> None:
    """Analyse a text as a single file; an internal error fails the test."""
    script = read(path, data, "odd")
    if isinstance(script, Script):
        report = perform(Task((script,), analyse=True), Config())
        assert [error.message for error in report.errors if error.bug] == []
