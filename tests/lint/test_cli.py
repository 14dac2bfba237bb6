import json
import os
import subprocess
import sys
from pathlib import Path

import jsonschema
import pytest

from tarl_lint import __version__
from tarl_lint.cli import main
from tarl_lint.report import FORMATS, paint
from tarl_lint.run import runner


@pytest.fixture
def node(example, in_directory) -> Path:
    return in_directory({"node.py": example.text}) / "node.py"


def lint(capsys: pytest.CaptureFixture[str], *arguments: str) -> tuple[int, str, str]:
    code = main(arguments)
    captured = capsys.readouterr()
    return code, captured.out, captured.err


def test_an_explicit_flow_is_shown_and_fails(node, capsys):
    code, out, err = lint(capsys, "node.py")
    assert code == 1
    assert out.startswith("node.py:18:9 publishes progress (Float64) in travel\n")
    assert "1 flow in 1 file: 1 explicit.\n" in out
    assert err == ""


def test_without_paths_the_working_directory_is_linted(node, capsys):
    assert lint(capsys) == lint(capsys, ".")


@pytest.mark.parametrize(
    ("arguments", "code"),
    [
        (["--exit-zero"], 0),
        (["--exit-zero", "--fail-on", "implicit"], 0),
        (["--fail-on", "never"], 0),
        (["--fail-on", "hazard"], 0),
        (["--fail-on", "implicit"], 1),
        (["--ignore", "TARL101"], 0),
        (["--select", "TARL102"], 0),
    ],
)
def test_options_decide_when_to_fail(node, capsys, arguments, code):
    assert lint(capsys, *arguments)[0] == code


def test_the_json_output_is_valid_by_the_schema(node, capsys):
    code, out, _ = lint(capsys, "--format", "json", "--exit-zero")
    schema = json.loads((Path(runner.__file__).parent.parent / "report/findings.schema.json").read_text())
    jsonschema.validate(json.loads(out), schema)
    assert code == 0
    assert json.loads(out)["diagnostics"][0]["path"] == "node.py"


def test_the_output_option_writes_the_report_to_a_file(node, capsys):
    code, out, _ = lint(capsys, "--format", "json", "--output-file", "report.json")
    assert (code, out) == (1, "")
    assert json.loads(Path("report.json").read_text())["files"] == 1
    code, _, err = lint(capsys, "--output-file", "no/such/report.txt")
    assert code == 2
    assert (
        err == "tarl-lint: The report cannot be written to no/such/report.txt: No such file or directory.\n"
    )


def test_accepted_flows_fail_only_without_the_baseline(node, capsys):
    code, out, _ = lint(capsys, "--write-baseline")
    assert (code, out) == (0, "tarl-flows.json: 1 flow accepted (1 new, 0 removed).\n")
    code, out, _ = lint(capsys)
    assert (code, out) == (0, "No new flow in 1 file (1 accepted in tarl-flows.json).\n")
    assert lint(capsys, "--no-baseline")[0] == 1
    node.write_text("x = 1\n")
    code, out, err = lint(capsys)
    assert code == 0
    assert "Accepted but no longer found, in tarl-flows.json:\n  odom → progress, explicit" in out
    code, out, err = lint(capsys, "--format", "json")
    assert json.loads(out)["diagnostics"] == []
    assert "odom → progress" in err
    assert lint(capsys, "--write-baseline")[1] == "tarl-flows.json: 0 flows accepted (0 new, 1 removed).\n"


def test_only_the_named_baseline_is_written(node, capsys):
    assert lint(capsys, "--baseline", "own.json", "--write-baseline")[1].startswith(
        "own.json: 1 flow accepted"
    )
    assert Path("own.json").exists()
    assert not Path("tarl-flows.json").exists()
    assert lint(capsys, "--baseline", "own.json")[0] == 0


def test_unreadable_files_are_reported_when_the_baseline_is_written(node, capsys):
    lint(capsys, "--write-baseline")
    node.write_text("def f(:\n")
    out = lint(capsys, "--write-baseline")[1]
    assert out == (
        "tarl-flows.json: 1 flow accepted (0 new, 0 removed, 1 kept from files that this run did not analyse).\n"
        "Not analysed: 1 file that is not readable as Python 3 (TARL001).\n"
    )


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (["--fromat", "json"], "There is no option --fromat: did you mean '--format'?"),
        (["--show-path"], "There is no option --show-path: did you mean '--show-paths'?"),
        (
            ["--format", "jsno"],
            "--format cannot be 'jsno': did you mean 'json'? It can be text, concise, json, json2, sarif, ",
        ),
        (["--fail-on", "all"], "--fail-on cannot be 'all'. It can be never, hazard, explicit, implicit."),
        (["--baseline"], "--baseline needs a value."),
        (["nod.py"], "nod.py: no such file or directory: did you mean node.py?"),
        (["empty"], "There is no Python file to lint in empty"),
        (["--config", "none.toml"], "The settings file none.toml cannot be read: No such file or directory."),
        (["--config", "bad.toml"], "bad.toml: [tool.tarl-lint] has no key 'selcet': did you mean 'select'?"),
        (
            ["--baseline", "none.json"],
            "The baseline none.json does not exist: create it with --write-baseline",
        ),
        (["--baseline", "bad.toml"], "The baseline bad.toml is damaged"),
        (["--no-baseline", "--write-baseline"], "--no-baseline and --write-baseline cannot be used together"),
        (["--select", "TARL9"], "--select names 'TARL9', which is not a rule"),
        (["--ignore", "E501"], "--ignore names 'E501', which is not a rule"),
        (["--explain", "TARL10"], "TARL10 stands for TARL101, TARL102, TARL103: name one of them."),
        (["--explain", "TARL1O1"], "There is no rule 'TARL1O1': did you mean 'TARL101'?"),
        (["--jobs", "0"], "--jobs: '0' is not a number of processes: write 1 or more, or auto."),
        (["--exclude", "src\\gen"], "--exclude: 'src\\\\gen' has backslashes: write it with slashes, as in"),
    ],
)
def test_unusable_input_ends_with_exit_code_2(node, capsys, arguments, sentence):
    (node.parent / "empty").mkdir()
    (node.parent / "bad.toml").write_text("selcet = []\n")
    code, out, err = lint(capsys, *arguments)
    assert (code, out) == (2, "")
    assert err.startswith(f"tarl-lint: {sentence}")
    assert err.count("\n") == 1


def test_version_and_help_are_printed(capsys):
    for option, expected in (("--version", f"tarl-lint {__version__}\n"), ("--help", "usage: tarl-lint")):
        with pytest.raises(SystemExit) as stop:
            main([option])
        assert stop.value.code == 0
        assert capsys.readouterr().out.startswith(expected)


def test_settings_are_shown_in_file_syntax(node, capsys):
    (node.parent / "pyproject.toml").write_text('[tool.tarl-lint]\nexclude = ["vendor/"]\n')
    code, out, _ = lint(capsys, "--show-settings", "--fail-on", "implicit")
    assert code == 0
    assert "# settings file: pyproject.toml\n" in out
    lines = [" ".join(line.split()) for line in out.splitlines()]
    assert 'exclude = ["vendor/"] # pyproject.toml' in lines
    assert 'fail-on = "implicit" # command line' in lines
    assert "select = [] # default" in lines


def test_an_internal_error_is_reported_in_one_sentence(node, capsys, monkeypatch):
    monkeypatch.setattr("tarl_lint.engine.examine", lambda modules, config, isolate, readings: 1 / 0)
    code, out, err = lint(capsys)
    assert (code, out) == (2, "")
    assert "tarl-lint has a bug and could not finish (ZeroDivisionError" in err


def test_an_interrupted_run_prints_one_line(node, capsys, monkeypatch):
    def interrupt(chosen, config, tell):
        raise KeyboardInterrupt

    monkeypatch.setattr(runner, "run", interrupt)
    assert lint(capsys) == (130, "", "tarl-lint: interrupted.\n")


def test_colours_are_used_only_on_capable_terminals():
    class Terminal:
        def isatty(self):
            return True

    class Pipe:
        def isatty(self):
            return False

    assert paint.wants_colour(Terminal(), {"TERM": "xterm"})
    assert not paint.wants_colour(Pipe(), {})
    assert not paint.wants_colour(Terminal(), {"NO_COLOR": "1"})
    assert not paint.wants_colour(Terminal(), {"TERM": "dumb"})
    assert paint.wants_colour(Terminal(), {"NO_COLOR": ""})
    assert paint.wants_colour(Pipe(), {"FORCE_COLOR": "1"})


def run(node: Path, *arguments: str, **environment: str) -> subprocess.CompletedProcess[bytes]:
    return subprocess.run(
        [sys.executable, "-m", "tarl_lint", *arguments],
        cwd=node.parent, capture_output=True, check=False, env={**os.environ, **environment},
    )  # fmt: skip


def test_forced_colours_do_not_change_the_text(node):
    import re

    coloured = run(node, FORCE_COLOR="1", NO_COLOR="", TERM="xterm-256color").stdout
    assert b"\x1b[" in coloured
    assert re.sub(rb"\x1b\[[0-9;]*m", b"", coloured) == run(node, NO_COLOR="1").stdout


def test_an_ascii_terminal_gets_replacement_signs(node):
    node.rename(node.parent / "nöde.py")
    done = run(node, PYTHONIOENCODING="ascii", NO_COLOR="1")
    assert done.returncode == 1
    assert done.stdout.startswith(b"n\\xf6de.py:18:9 publishes progress")
    assert done.stderr == b""


def test_a_closed_pipe_is_not_an_error(node):
    node.write_text(node.read_text() + "# filler\n" * 10)
    command = f"{sys.executable} -m tarl_lint --format json --exit-zero; echo code $? >&2"
    done = subprocess.run(
        ["bash", "-c", f"({command}) | true"], cwd=node.parent, capture_output=True, check=False
    )
    assert done.stderr == b"code 0\n"


def test_ctrl_c_ends_a_real_run_with_one_line(node):
    program = (
        "import os, signal, sys, tarl_lint.run.runner as r\n"
        "from tarl_lint.cli import main\n"
        "r.run = lambda *a: os.kill(os.getpid(), signal.SIGINT) or signal.pause()\n"
        "sys.exit(main([]))"
    )
    done = subprocess.run([sys.executable, "-c", program], cwd=node.parent, capture_output=True, check=False)
    assert (done.returncode, done.stdout, done.stderr) == (130, b"", b"tarl-lint: interrupted.\n")


def test_the_installed_command_runs(node):
    command = Path(sys.executable).parent / "tarl-lint"
    done = subprocess.run([str(command), "--version"], capture_output=True, check=False, text=True)
    assert done.stdout == f"tarl-lint {__version__}\n"


def test_every_format_is_written(node, capsys):
    for name in FORMATS:
        code, out, _ = lint(capsys, "--format", name)
        assert code == 1
        assert "progress" in out


def test_rules_can_be_ignored_in_some_files(node, capsys):
    assert lint(capsys, "--per-file-ignores", "no*.py:TARL101,TARL2")[0] == 0
    assert lint(capsys, "--per-file-ignores", "other.py:TARL101")[0] == 1
    (node.parent / "pyproject.toml").write_text('[tool.tarl-lint.per-file-ignores]\n"node.py" = ["TARL1"]\n')
    code, out, _ = lint(capsys)
    said = (
        "No further flow from a subscription to a publish call in 1 file.\nSilenced: 1 by per-file-ignores.\n"
    )
    assert (code, out) == (0, said)


@pytest.mark.parametrize(
    ("value", "sentence"),
    [
        (
            "node.py",
            "--per-file-ignores: 'node.py' does not have the form PATTERN:CODES, such as 'tests/:TARL1'.",
        ),
        ("src\\node.py:TARL1", "--per-file-ignores: 'src\\\\node.py' has backslashes"),
        ("node.py:TARL9", "--per-file-ignores names 'TARL9', which is not a rule"),
    ],
)
def test_invalid_per_file_ignores_are_refused(node, capsys, value, sentence):
    code, _, err = lint(capsys, "--per-file-ignores", value)
    assert code == 2
    assert err.startswith(f"tarl-lint: {sentence}")


def test_shown_settings_read_back_as_the_same_settings(node, capsys):
    text = (
        '[tool.tarl-lint]\nsinks = ["bus.send"]\ntf2 = true\nremaps = {"scan" = "/front/scan"}\n'
        'per-file-ignores = {"tests/" = ["TARL1"]}\n'
        '[tool.tarl-lint.wrappers]\n"bus.listen" = "rospy.Subscriber"\n'
        '"bus.talk" = {like = "rospy.Publisher", topic = 1}\n'
    )
    (node.parent / "pyproject.toml").write_text(text)
    _, shown, _ = lint(capsys, "--show-settings")
    assert "# pyproject.toml" in shown
    (node.parent / "again.toml").write_text(shown.replace('baseline = ""', ""))
    _, again, _ = lint(capsys, "--show-settings", "--config", "again.toml")
    values = [[line.split("  #")[0] for line in text.splitlines()[2:]] for text in (shown, again)]
    assert values[0] == values[1]


def test_statistics_count_the_publish_calls_that_each_topic_reaches(node, capsys):
    _, out, _ = lint(capsys, "--statistics")
    assert "Publish calls reached, by subscribed topic:\n1  odom\n" in out


def test_progress_is_shown_on_terminals_only(node, capsys, monkeypatch):
    told = []
    monkeypatch.setattr("tarl_lint.run.progress.Progress.tell", lambda self, text: told.append(text))
    lint(capsys)
    assert told == []
    monkeypatch.setattr(sys.stderr, "isatty", lambda: True)
    lint(capsys)
    assert told == ["Looking for files", "Reading 1 file"]  # the rest was cached
    lint(capsys, "--no-cache")
    assert told[2:] == ["Looking for files", "Reading 1 file", "Analysing node.py (1 of 1)"]
