from pathlib import Path

import pytest

from tarl_lint.cli import main
from tarl_lint.explain import known_rules, page
from tarl_lint.model import RULES

DOCS = Path(__file__).parents[2] / "docs"


@pytest.mark.parametrize("code", sorted(known_rules()))
def test_the_page_of_a_rule_matches_its_module(code):
    written = (DOCS / "rules" / f"{code}.md").read_text("utf-8")
    assert written == page(code), "run: python -m tarl_lint.explain docs/rules"


def test_the_guide_names_every_rule():
    guide = (DOCS / "lint.md").read_text("utf-8")
    assert [code for code in known_rules() if f"(rules/{code}.md)" not in guide] == []


def test_explain_prints_the_page_without_its_markup(capsys):
    assert main(["--explain", "tarl101"]) == 0
    out = capsys.readouterr().out
    assert out.startswith("TARL101: ")
    assert "Not reported\n" in out
    assert "```" not in out
    assert "        brake.publish(force)\n" in out


def test_consecutive_examples_are_separated(capsys):
    main(["--explain", "TARL204"])
    out = capsys.readouterr().out
    assert (
        "send(side, value):\n        pubs[side].publish(value)\n\n    --------\n\n    import rospy\n" in out
    )
    assert out.count("--------") == 1


def test_rule_codes_elsewhere_exist():
    assert tuple(known_rules()) == RULES


def test_the_guide_matches_the_output_of_the_command(capsys, monkeypatch):
    monkeypatch.chdir(DOCS.parent)
    main(["examples/shuttle/traveller.py"])
    printed = "$ tarl-lint examples/shuttle/traveller.py\n" + capsys.readouterr().out
    assert f"```console\n{printed}```" in (DOCS / "lint.md").read_text("utf-8")
