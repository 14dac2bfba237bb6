"""The closing lines of a report are true for any selection, silenced findings and missing files."""

from textwrap import dedent

import pytest

from tarl_lint.cli import main

BOTH = """
    import rospy
    from std_msgs.msg import Bool, Float64
    pub = rospy.Publisher("/out", Float64, queue_size=1)
    def on_value(msg):
        if msg.data:
            pub.publish(1.0)
        pub.publish(msg.data){comment}
    rospy.Subscriber("/in", Float64, on_value)
"""


@pytest.fixture
def said(in_directory, capsys):
    """Return the closing lines of a run."""

    def run(*arguments: str, comment: str = "") -> list[str]:
        in_directory({"node.py": dedent(BOTH).format(comment=comment)})
        main(["--format", "concise", *arguments])
        lines = capsys.readouterr().out.splitlines()
        return [line for line in lines if not line.startswith("node.py")]

    return run


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ([], ["2 flows in 1 file: 1 explicit, 1 implicit."]),
        (["--select", "TARL102"], ["1 flow in 1 file: 1 implicit."]),
        (["--select", "TARL2"], ["No hazard in 1 file."]),
        (["--select", "TARL001"], ["1 file read; no rule for flows or hazards is enabled."]),
        (["--ignore", "TARL"], ["1 file read; no rule for flows or hazards is enabled."]),
        (
            ["--per-file-ignores", "node.py:TARL1"],
            [
                "No further flow from a subscription to a publish call in 1 file.",
                "Silenced: 2 by per-file-ignores.",
            ],
        ),
        (
            ["--per-file-ignores", "node.py:TARL1", "--select", "TARL102"],
            [
                "No further implicit flow from a subscription to a publish call in 1 file.",
                "Silenced: 1 by per-file-ignores.",
            ],
        ),
    ],
)
def test_rules_that_did_not_run_are_not_clean(said, arguments, words):
    assert said(*arguments) == words


@pytest.mark.parametrize(
    ("files", "words"),
    [
        ({"tool.py": "print(2)\n"}, "No flow: nothing in 1 file subscribes or publishes."),
        (
            {"a.py": "# publish later\n", "b.py": '"""A Subscriber."""\n'},
            "No flow: nothing in 2 files subscribes or publishes.",
        ),
        (
            {"node.py": "import rospy\nrospy.Subscriber('/in', Bool, print)\n"},
            "No flow from a subscription to a publish call in 1 file.",
        ),
    ],
)
def test_report_lists_files_without_endpoints(in_directory, capsys, files, words):
    in_directory(files)
    for _ in range(2):  # the second run reads the cache
        main(["--format", "concise"])
        assert words in capsys.readouterr().out.splitlines()


@pytest.mark.parametrize("follows", [False, True])
def test_report_names_the_client_setting_unless_on(in_directory, capsys, follows):
    node = "import rospy\nask = rospy.ServiceProxy('speed', GetSpeed)\n"
    in_directory({"node.py": node, "pyproject.toml": f"[tool.tarl-lint]\nclients = {str(follows).lower()}\n"})
    main(["--format", "text"])
    assert ("in 1 file (clients = true)" in capsys.readouterr().out) is not follows


def test_a_configured_source_counts_as_a_subscription(in_directory, capsys):
    settings = "[tool.tarl-lint]\nsources = ['driver.read']\n"
    in_directory({"tool.py": "import driver\nprint(driver.read())\n", "pyproject.toml": settings})
    main(["--format", "concise"])
    assert "No flow from a subscription to a publish call in 1 file." in capsys.readouterr().out


def test_silenced_findings_are_counted(said):
    assert said(comment="  # tarl: ignore") == ["1 flow in 1 file: 1 implicit.", "Silenced: 1 by comments."]


@pytest.mark.parametrize(
    ("comment", "arguments", "noted"),
    [
        ("ignore", ["--ignore", "TARL1"], False),
        ("ignore", ["--select", "TARL102"], False),
        ("ignore[TARL1]", ["--select", "TARL102"], False),
        ("ignore[TARL2]", ["--select", "TARL2"], True),
        ("ignore[TARL202]", ["--select", "TARL202"], True),
        ("ignore[TARL101]", [], False),
        ("ignore[TARL999]", ["--select", "TARL2"], True),
    ],
)
def test_comment_is_unused_only_if_its_rules_ran(in_directory, capsys, comment, arguments, noted):
    in_directory({"node.py": dedent(BOTH).format(comment=f"  # tarl: {comment}")})
    main(["--format", "concise", *arguments])
    assert (" note: " in capsys.readouterr().out) is noted


def test_comment_with_an_unknown_rule_has_its_message(in_directory, capsys):
    in_directory({"node.py": dedent(BOTH).format(comment="  # tarl: ignore[TARL1O1]")})
    main(["--format", "concise"])
    note = "node.py:8:28 note: there is no rule TARL1O1: correct or remove this comment.\n"
    assert note in capsys.readouterr().out
    main(["--format", "github"])
    assert "::There is no rule TARL1O1: correct or remove this comment" in capsys.readouterr().out


def test_the_concise_format_lists_vanished_findings(in_directory, capsys):
    root = in_directory({"node.py": dedent(BOTH).format(comment="")})
    main(["--write-baseline"])
    (root / "node.py").write_text("")
    capsys.readouterr()
    main(["--format", "concise"])
    out = capsys.readouterr().out
    assert "  /in → /out, explicit, received by on_value, published in on_value (node)\n" in out
    assert "\n\n" not in out


def test_settings_are_shown_even_if_their_baseline_is_missing(in_directory, capsys):
    in_directory({"pyproject.toml": '[tool.tarl-lint]\nbaseline = "flows.json"\n', "node.py": ""})
    assert main(["--show-settings"]) == 0
    assert 'baseline = "flows.json" ' in capsys.readouterr().out
    assert main([]) == 2
    assert "The baseline flows.json does not exist" in capsys.readouterr().err
