"""Placeholders in the texts of templates."""

from __future__ import annotations

from pathlib import Path

import pytest

from pytest_tarl.patching.templates import Parameter, Template, filled, plainly, template, templates


@pytest.mark.parametrize(
    ("text", "values", "expected"),
    [
        ("{x}", {"x": "a + b"}, "a + b"),
        ("f({x}, {y})", {"x": "a + b", "y": "c or d"}, "f(a + b, c or d)"),
        ("{x} * {k}", {"x": "a + b", "k": "0.5"}, "(a + b) * 0.5"),
        ("{x} * {k}", {"x": "a * b", "k": "0.5"}, "a * b * 0.5"),
        ("{k} * {x}", {"x": "a * b", "k": "0.5"}, "0.5 * (a * b)"),
        ("{x} + {k}", {"x": "a * b", "k": "0.5"}, "a * b + 0.5"),
        ("{x} + {k}", {"x": "a + b", "k": "0.5"}, "a + b + 0.5"),
        ("{x} + {k}", {"x": "a if b else c", "k": "0.5"}, "(a if b else c) + 0.5"),
        ("{x} + {k}", {"x": "a", "k": "-0.5"}, "a - 0.5"),
        ("{x} + {k}", {"x": "a", "k": "-1e-05"}, "a - 1e-05"),
        ("{x} + {k}", {"x": "a", "k": "-b"}, "a + (-b)"),
        ("{x} + {k} * y", {"x": "a", "k": "-0.5"}, "a - 0.5 * y"),
        ("({x} {op} {k})", {"x": "a", "op": "<", "k": "3"}, "(a < 3)"),
        ("-{x}", {"x": "a + b"}, "-(a + b)"),
        ("[{x}]", {"x": "a + b"}, "[(a + b)]"),
    ],
)
def test_placeholders_get_parentheses_only_where_they_are_needed(
    text: str, values: dict[str, str], expected: str
) -> None:
    assert filled(text, values) == expected


def test_unknown_placeholders_of_a_sentence_are_kept() -> None:
    assert plainly("move {x} by {k}", {"x": "speed"}) == "move speed by {k}"


def test_placeholder_uses_are_counted() -> None:
    found = Template("t", "s", "value", 1, "{x} + {x} * {k}", lines=("{k} = {x}", "y = {x}"))
    assert [found.uses(name) for name in ("x", "k", "y")] == [4, 2, 0]


def test_a_template_has_defaults_for_what_its_file_omits(tmp_path: Path) -> None:
    path = tmp_path / "mine.toml"
    path.write_text(
        'summary = "x"\non = "value"\ncost = 2\nexpression = "{x} * {k}"\n[parameters]\nk = {default = 2}\n'
    )
    assert template(path) == Template(
        "mine", "x", "value", 2, "{x} * {k}", parameters=(Parameter("k", 2.0, "", "larger", 0.0, False),)
    )
    path.write_text(
        'summary = "x"\non = "value"\ncost = 2\nexpression = "{s}"\nlines = ["{s} = {x}"]\nsymptoms = ["noise"]\n'
        'without = "term"\n[state]\ns = 0.0\n[parameters]\n'
        'k = {default = 2, of = "typical", stronger = "smaller", grid = 0.5, signed = true}\n'
    )
    assert template(path) == Template(
        "mine",
        "x",
        "value",
        2,
        "{s}",
        ("{s} = {x}",),
        (("s", "0.0"),),
        (Parameter("k", 2.0, "typical", "smaller", 0.5, True),),
        "term",
        ("noise",),
    )


def test_templates_are_sorted_by_cost_and_name(
    tmp_path: Path,
) -> None:
    (tmp_path / "tarl_templates").mkdir()
    for name, cost in (("aaa", 1), ("zzz", 0)):
        (tmp_path / "tarl_templates" / f"{name}.toml").write_text(
            f'summary = "x"\non = "value"\ncost = {cost}\nexpression = "{{x}}"\n'
        )
    found = templates(tmp_path)
    assert found[0].name == "zzz"
    costs = [one.cost for one in found]
    assert costs == sorted(costs)
    cheap = [one.name for one in found if one.cost == 1]
    assert cheap == [*sorted(cheap[:-1]), "aaa"]
