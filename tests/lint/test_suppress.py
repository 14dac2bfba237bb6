import pytest

from tarl_lint.model import Finding, Span
from tarl_lint.suppress import apply, suppressions


def finding(line: int, code: str = "TARL101", end: int | None = None) -> Finding:
    return Finding(code, Span("node.py", line, 1, end or line, 10), "…")


def kept(text: str, *findings: Finding) -> list[str]:
    return [f.code for f in apply(findings, {"node.py": text})[0]]


@pytest.mark.parametrize(
    "comment",
    [
        "# tarl: ignore",
        "# tarl: ignore[TARL101]",
        "#tarl:ignore[tarl101]",
        "# tarl: ignore[TARL102, TARL101]",
        "# noqa: TARL101",
        "# noqa: E501, TARL101",
        "# noqa:E501,TARL101 - the designers know",
        "# type: ignore  # tarl: ignore[TARL101]",
        "# tarl: ignore[TARL1]",
        "# tarl: ignore [TARL101]",
        "# noqa: TARL1",
    ],
)
def test_a_comment_on_the_line_silences_the_rule(comment):
    assert kept(f"pub.publish(x)  {comment}\n", finding(1)) == []


@pytest.mark.parametrize(
    "comment",
    [
        "# tarl: ignore[TARL102]",
        "# tarl: ignore[]",
        "# noqa",
        "# noqa: E501",
        "# noqa: TARL102",
        "# tarl: ignored by us",
        "# tarl: ignore [TARL102]",
        "# tarl: ignore[T]",
        "# ignore",
        "",
    ],
)
def test_comments_for_another_rule_or_tool_silence_nothing(comment):
    assert kept(f"pub.publish(x)  {comment}\n", finding(1)) == ["TARL101"]


def test_comment_on_a_line_of_the_call_silences_it():
    text = "a = 1  # tarl: ignore\npub.publish(\n    x,  # tarl: ignore\n)\n"
    assert kept(text, finding(2, end=4)) == []
    assert kept(text, finding(4)) == ["TARL101"]


def test_one_comment_silences_several_findings_of_its_line():
    assert kept("p(x)  # tarl: ignore\n", finding(1), finding(1, "TARL102")) == []


def test_a_comment_in_a_string_has_no_effect():
    text = 'pub.publish("# tarl: ignore")\n'
    assert kept(text, finding(1)) == ["TARL101"]
    assert suppressions("node.py", text) == ()


def test_each_unused_rule_of_a_comment_is_reported():
    text = "p(x)  # tarl: ignore[TARL101, TARL102]\nq(y)  # tarl: ignore\nr(z)  # noqa: E501\n"
    _, silenced, unused = apply([finding(1)], {"node.py": text})
    assert silenced == (finding(1),)
    assert [(s.line, s.column, s.code) for s in unused] == [(1, 7, "TARL102"), (2, 7, "")]


def test_comments_before_a_tokenizer_error_still_apply():
    assert kept("p(x)  # tarl: ignore\n'''\n", finding(1)) == []
