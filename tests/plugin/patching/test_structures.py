"""Templates of structural repairs: their examples, templates of the project, and properties of the written code."""

from __future__ import annotations

import ast
from pathlib import Path
from typing import Any

import pytest

from pytest_tarl.errors import RepairError, SettingsError
from pytest_tarl.patching.document import apply_edits, document
from pytest_tarl.patching.structures import Form, form_edits
from pytest_tarl.patching.templates import SHIPPED, contents, template, templates
from tarl_lint.model import Span

FILES = sorted(SHIPPED.glob("*.toml"))


def span(text: str, code: str) -> Span:
    start = text.index(code)
    line, column = text.count("\n", 0, start) + 1, start - (text.rfind("\n", 0, start) + 1) + 1
    return Span("node.py", line, column, line, column + len(code))


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.stem)
def test_a_template_writes_its_example(path: Path) -> None:
    example = contents(path)["example"]
    before = example["before"].lstrip("\n")
    partner = span(before, example["pair"]) if "pair" in example else None
    form = Form(template(path), partner=partner, field=example.get("field", ""))
    source = document("node.py", before)
    node = source.find(span(before, example["at"]))
    edits = form_edits(source, node, form, example.get("values", {}), "", example.get("sensor", ""))
    assert apply_edits(source, edits) == example["after"].lstrip("\n")


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.stem)
def test_original_value_is_used_outside_the_condition(path: Path) -> None:
    example = contents(path)["example"]
    before = example["before"].lstrip("\n")
    partner = span(before, example["pair"]) if "pair" in example else None
    source = document("node.py", before)
    node = source.find(span(before, example["at"]))
    edits = form_edits(
        source,
        node,
        Form(template(path), partner=partner, field=example.get("field", "")),
        example.get("values", {}),
        "wet",
        example.get("sensor", ""),
    )
    text = apply_edits(source, edits)
    chosen = [each for each in ast.walk(ast.parse(text)) if isinstance(each, ast.IfExp)]
    assert any(ast.unparse(each.test) == "wet" for each in chosen)


def test_every_template_is_in_the_docs() -> None:
    page = (Path(__file__).parents[3] / "docs" / "structures.md").read_text("utf-8")
    assert [path.stem for path in FILES if f"`{path.stem}`" not in page] == []
    for path in FILES:
        assert contents(path)["example"]["after"].strip("\n").splitlines()[-1] in page


def test_project_templates_can_replace_built_in_ones(tmp_path: Path) -> None:
    folder = tmp_path / "tarl_templates"
    folder.mkdir()
    (folder / "root.toml").write_text(
        'summary = "take the root"\non = "value"\ncost = 2\nexpression = "math.sqrt({x})"\n'
    )
    (folder / "sign.toml").write_text(
        'summary = "other"\non = "value"\ncost = 9\nexpression = "-1.0 * {x}"\n'
    )
    found = {one.name: one for one in templates(tmp_path)}
    assert found.keys() == {path.stem for path in FILES} | {"root"}
    assert found["sign"].cost == 9
    costs = [one.cost for one in templates(tmp_path)]
    assert costs == sorted(costs)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("summary = ", "cannot be read as TOML"),
        ('summary = "s"\non = "value"\ncost = 1\n', "it needs summary, on, cost and expression"),
        ('summary = "s"\non = "values"\ncost = 1\nexpression = "{x}"\n', "on = 'values' is unknown"),
        ('summary = "s"\non = "value"\ncost = 1\nexpression = "{z}"\n', "unknown placeholder {z}"),
        ('summary = "s"\non = "value"\ncost = 1\nexpression = "{x}"\nlimes = 3\n', "has no key 'limes'"),
        (
            'summary = "s"\non = "value"\ncost = 1\nexpression = "{x}"\n[parameters.a]\ndefault = 1\nof = "it"\n',
            "of = 'it' is unknown",
        ),
        (
            'summary = "s"\non = "number"\nwithout = "sum"\ncost = 1\nexpression = "{x}"\n',
            "without = 'sum' is unknown",
        ),
        (
            'summary = "s"\non = "value"\ncost = 1\nexpression = "{x}"\nparameters = 3\n',
            "not a template",
        ),
    ],
)
def test_an_invalid_template_is_explained(tmp_path: Path, text: str, words: str) -> None:
    (tmp_path / "own.toml").write_text(text)
    with pytest.raises(SettingsError) as raised:
        template(tmp_path / "own.toml")
    assert words in str(raised.value)
    assert "own.toml" in str(raised.value)


HOLDER = """\
class Node:
    def __init__(self):
        self.gain = 2.0

    def wanted(self, error):
        {statement}
"""


@pytest.mark.parametrize(
    ("statement", "at", "lines"),
    [
        (
            "return self.gain * error",
            "self.gain * error",
            ["value = self.gain * error", "{limited}", "return self.last_value"],
        ),
        (
            "self.send(Float64(data=self.gain * error))",
            "self.gain * error",
            ["value = self.gain * error", "{limited}", "self.send(Float64(data=self.last_value))"],
        ),
        (
            "self.speed += self.gain * error",
            "self.gain * error",
            ["value = self.gain * error", "{limited}", "self.speed += self.last_value"],
        ),
        (
            "cmd.linear.x = self.speed_for(error)",
            "self.speed_for(error)",
            [
                "cmd.linear.x = self.speed_for(error)",
                "self.last_x += max(-0.1, min(0.1, cmd.linear.x - self.last_x))",
                "cmd.linear.x = self.last_x",
            ],
        ),
    ],
)
def test_unnamed_value_is_assigned_before_its_statement(statement: str, at: str, lines: list[str]) -> None:
    limited = "self.last_value += max(-0.1, min(0.1, value - self.last_value))"
    before = HOLDER.format(statement=statement)
    source = document("node.py", before)
    form = Form(template(SHIPPED / "rate_limit.toml"))
    text = apply_edits(source, form_edits(source, source.find(span(before, at)), form, {"step": 0.1}, "", ""))
    ast.parse(text)
    assert text.split("\n")[6:-1] == [f"        {line.format(limited=limited)}" for line in lines]


@pytest.mark.parametrize(
    ("statement", "at"),
    [
        ("return [self.gain * x for x in error]", "self.gain * x"),
        ("return 0.0 if error is None else self.gain * error", "self.gain * error"),
        ("return error and self.gain * error", "self.gain * error"),
        ("return lambda x: self.gain * x", "self.gain * x"),
        ("while self.gain * error > 1.0: error -= 1.0", "self.gain * error"),
    ],
)
def test_conditionally_evaluated_value_stays_in_its_statement(statement: str, at: str) -> None:
    before = HOLDER.format(statement=statement)
    source = document("node.py", before)
    form = Form(template(SHIPPED / "rate_limit.toml"))
    with pytest.raises(RepairError):
        form_edits(source, source.find(span(before, at)), form, {"step": 0.1}, "", "")


PLACES = {  # where a statement may stand, as the first one or alone
    "function": "def steer(error):\n    {statement}\n",
    "function with docstring": 'def steer(error):\n    """Steer."""\n    {statement}\n',
    "constructor": "class Node:\n    def __init__(self, error):\n        {statement}\n",
    "method": "class Node:\n    def steer(self, error):\n        {statement}\n",
    "loop": "def main():\n    while True:\n        error = read()\n        {statement}\n",
}


@pytest.mark.parametrize("place", PLACES)
@pytest.mark.parametrize("statement", ["turn = 2.0 * error", "send(2.0 * error)", "return 2.0 * error"])
@pytest.mark.parametrize("path", [each for each in FILES if template(each).state], ids=lambda path: path.stem)
def test_state_is_declared_before_its_first_use(path: Path, statement: str, place: str) -> None:
    made = template(path)
    if made.on == "comparison":
        statement = f"if 2.0 * error > 1.0: {statement}"
    source = document("node.py", PLACES[place].format(statement=statement))
    values = {one.name: 1.0 for one in made.parameters}
    code = "2.0 * error > 1.0" if made.on == "comparison" else "2.0 * error"
    node = source.find(span(source.text, code))
    text = apply_edits(source, form_edits(source, node, Form(made), values, "", "error"))  # compiles it
    globals_ = [each for each in ast.walk(ast.parse(text)) if isinstance(each, ast.Global)]
    assert bool(globals_) == place.startswith("function")


@pytest.mark.parametrize(
    ("expression", "written"),
    [("margin", "margin + (self.length or 0.0)"), ("2.0 * gap", "2.0 * gap + (self.length or 0.0)")],
)
def test_expression_for_a_missing_sensor_has_one_pair_of_parentheses(expression: str, written: str) -> None:
    source = document("node.py", f"close = gap < {expression}\n")
    node = source.find(span(source.text, expression))
    edits = form_edits(source, node, Form(template(SHIPPED / "sum.toml")), {}, "", "self.length or 0.0")
    assert apply_edits(source, edits) == f"close = gap < {written}\n"


@pytest.mark.parametrize(
    ("name", "values", "second"),
    [("low_pass", {"share": 0.25}, 6.5), ("derivative", {"gain": 3.0}, 14.0)],
)
def test_a_template_with_memory_passes_the_first_value_unchanged(
    name: str, values: dict[str, float], second: float
) -> None:
    before = "def step(value):\n    out = 2.0 * value\n    return out\n"
    source = document("node.py", before)
    node = source.find(span(before, "2.0 * value"))
    edits = form_edits(source, node, Form(template(SHIPPED / f"{name}.toml")), values, "", "")
    scope: dict[str, Any] = {}
    exec(apply_edits(source, edits), scope)
    assert [scope["step"](3.0), scope["step"](4.0)] == [6.0, second]
