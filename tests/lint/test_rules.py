"""The snippets in the rules' modules are their tests."""

import pytest

from tarl_lint import engine
from tarl_lint.explain import known_rules
from tarl_lint.read.source import Module, SourceError, parse
from tarl_lint.settings.config import Config

SNIPPETS = [
    pytest.param(code, name, text, id=f"{code} {name} {number}")
    for code, rule in known_rules().items()
    if not code.startswith("TARL3")  # rules of launch files: test_architecture.py
    for name in ("VALID", "INVALID")
    for number, text in enumerate(getattr(rule, name))
]


def reported(text: str) -> set[str]:
    from inspect import cleandoc

    module = parse("snippet.py", cleandoc(text).encode(), "snippet")
    if isinstance(module, SourceError):
        return {"TARL001"}
    assert isinstance(module, Module)
    return {f.code for f in engine.lint([module], Config())}


@pytest.mark.parametrize(("code", "name", "text"), SNIPPETS)
def test_snippets_are_valid_or_invalid_as_declared(code, name, text):
    assert (code in reported(text)) == (name == "INVALID")


def test_every_rule_has_both_kinds_of_snippets():
    for rule in known_rules().values():
        assert rule.VALID
        assert rule.INVALID
        assert rule.SUMMARY[0].islower()


def test_finding_at_the_publish_call_names_both_topics():
    text = known_rules()["TARL101"].INVALID[0]
    from inspect import cleandoc

    module = parse("snippet.py", cleandoc(text).encode(), "snippet")
    assert isinstance(module, Module)
    (finding,) = engine.lint([module], Config(select=("TARL101",)))
    assert finding.message == "/range (Range) reaches /brake (Float64)"
    assert finding.flow is not None
    assert finding.span == finding.flow.sink.span
