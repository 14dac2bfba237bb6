"""The code in each recipe for contributors does what the recipe says, in the file that it names."""

from __future__ import annotations

import csv
import re
from pathlib import Path
from types import SimpleNamespace

import pytest

from pytest_tarl.patching.document import apply_edits, document
from pytest_tarl.patching.mutate import mutations
from pytest_tarl.patching.structures import Form, form_edits
from pytest_tarl.patching.templates import contents, template
from pytest_tarl.ros import install
from pytest_tarl.ros.messages import find_class, known, type_definitions
from pytest_tarl.ros.messages.package_modules import could_be_package
from pytest_tarl.ros.rospy import node as rospy_node
from pytest_tarl.ros.standins import STANDINS
from pytest_tarl.searching.accept import Outcome
from pytest_tarl.searching.ask_tell import Asking
from pytest_tarl.searching.candidates import ALWAYS
from pytest_tarl.searching.search import Candidate, Trials
from tarl_lint import engine
from tarl_lint.evidence import Evidence
from tarl_lint.flows.reachability import Tracer
from tarl_lint.interpret.interpreter import Interpreter
from tarl_lint.interpret.invocation import Invocation
from tarl_lint.memory import recency
from tarl_lint.memory.values import Value, pointer
from tarl_lint.models import library_functions
from tarl_lint.prefilter.one_sided_groups import Side
from tarl_lint.read.source import Module, parse
from tarl_lint.report.line import View
from tarl_lint.run import runner
from tarl_lint.settings.config import Config, Options, resolve
from tests.lint.analysing import analysed
from tests.plugin.patching.test_structures import span
from tests.plugin.ros.conftest import start  # noqa: F401 - a fixture
from tests.plugin.searching.test_search import BIAS, GAIN, GOAL, LIMIT, reward

ROOT = Path(__file__).parent.parent
PAGES = sorted((ROOT / "docs" / "contributing").glob("*.md"))
FOLDERS = ("benchmarks", "docs", "pytest_tarl", "tarl_lint", "tests", "website")
NODE = """
import rospy
from std_msgs.msg import Float64
from gadgets import outline

pub = rospy.Publisher("/out, 1", Float64, queue_size=1)
rospy.Subscriber("/in", Float64, lambda message: pub.publish(outline(message.data)))
"""


def snippets(page: str, language: str) -> list[str]:
    """Return the blocks of code of a page, without their indentation."""
    text = (ROOT / "docs" / "contributing" / page).read_text("utf-8")
    blocks = re.findall(rf"^( *)```{language}\n(.*?)^\1```", text, re.MULTILINE | re.DOTALL)
    return [re.sub(rf"^{indent}", "", code, flags=re.MULTILINE) for indent, code in blocks]


def made(code: str, **names: object) -> SimpleNamespace:
    """Run the code of a module that already has some names."""
    space: dict[str, object] = {"__name__": "recipe", **names}
    exec(compile(code, "recipe.py", "exec"), space)
    return SimpleNamespace(**space)


def module(text: str) -> Module:
    parsed = parse("node.py", re.sub(r"^ {4}", "", text, flags=re.MULTILINE).encode(), "node")
    assert isinstance(parsed, Module)
    return parsed


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_the_files_that_a_recipe_names_exist(page: Path) -> None:
    names = re.findall(r"`([\w/.-]+/[\w.-]+\.(?:py|toml|md)|[\w.-]+\.(?:py|toml))`", page.read_text("utf-8"))
    tracked = {str(path) for folder in FOLDERS for path in (ROOT / folder).rglob("*.*")}
    tracked |= {str(path) for path in ROOT.iterdir()}
    written = [name for name in names if not re.search(r"NAME|2NN|recipe", name)]
    assert [name for name in written if not any(path.endswith(f"/{name}") for path in tracked)] == []


def test_recipe_rule_reports_its_invalid_nodes() -> None:
    (code,) = snippets("rule.md", "python")
    rule = made(code)
    for text, expected in [*((t, True) for t in rule.INVALID), *((t, False) for t in rule.VALID)]:
        modules = [module(text)]
        machine, flows = engine.trace(modules, Config())
        found = list(rule.findings(Evidence(Tracer(machine), flows)))
        assert bool(found) is expected
        assert all(finding.code == rule.CODE for finding in found)
        assert not rule.ruled_out(Side(modules, [text], hears=True, says=False))


def test_the_recipe_of_a_format_gives_a_document(tmp_path: Path) -> None:
    (code,) = snippets("format.md", "python")
    (tmp_path / "node.py").write_text(NODE)
    (tmp_path / "broken.py").write_text("def f(:\n")
    options = Options(paths=(tmp_path,), cache=False)
    result = runner.run(options, resolve(options))
    lines = ["".join(text for text, _ in line) for line in made(code).report(result, View())]
    rows = list(csv.reader(lines))
    assert rows[0] == ["code", "path", "line", "message"]
    assert [row[0] for row in rows[1:]] == ["TARL001", "TARL101"]
    assert "/out, 1" in rows[2][3]


def test_recipe_model_replaces_the_default(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (code,) = snippets("model.md", "python")
    assert [flow.kind for flow in analysed(tmp_path, node=NODE).flows] == ["explicit"]
    model = made(
        code, Interpreter=Interpreter, Invocation=Invocation, Value=Value, pointer=pointer, recency=recency
    )
    monkeypatch.setitem(library_functions.BUILTIN, "gadgets.outline", model.only_its_shape)
    assert [flow.kind for flow in analysed(tmp_path, node=NODE).flows] != ["explicit"]


def test_recipe_ros_api_passes_its_test(start, monkeypatch: pytest.MonkeyPatch) -> None:  # noqa: F811
    test, function = snippets("ros.md", "python")
    assert STANDINS["rospy.names"] == "rospy.node"
    written = made(function, this_node=rospy_node.this_node)
    monkeypatch.setitem(vars(rospy_node), "get_mappings", written.get_mappings)
    monkeypatch.setattr(install, "_contents", install._contents.__wrapped__)  # bypass the cache
    made(test).test_get_mappings(start)


def test_the_recipe_of_a_template_writes_its_example(tmp_path: Path) -> None:
    (text,) = snippets("template.md", "toml")
    path = tmp_path / "cube.toml"
    path.write_text(text)
    example = contents(path)["example"]
    source = document("node.py", example["before"])
    place = source.find(span(example["before"], example["at"]))
    edits = form_edits(source, place, Form(template(path)), example["values"], "", "")
    assert apply_edits(source, edits) == example["after"]


def test_recipe_message_type_passes_its_test(monkeypatch: pytest.MonkeyPatch) -> None:
    (definition,) = snippets("message.md", "text")
    (test,) = snippets("message.md", "python")
    assert could_be_package("depth_msgs")
    types = {**known.known_types("ros1", "msg"), **known._split(definition)}
    monkeypatch.setattr(type_definitions, "known_types", lambda kind, part: types)
    made(test, find_class=find_class, pytest=pytest).test_the_new_type_has_its_fields_and_constants()


def test_recipe_search_finds_the_constant() -> None:
    (code,) = snippets("search.md", "python")

    def run(candidate: Candidate, seed: int) -> Outcome:
        gain = next((m for m in candidate.mutations if m.operand == GAIN), None)
        return Outcome(reward(gain, seed), passed=True)

    search = Asking(
        "recipe:Search",
        made(code).Search,
        (LIMIT, GAIN, BIAS),
        mutations,
        (ALWAYS,),
        Trials(run, 300),
        GOAL,
        7,
    )
    repair = next(search.candidates())
    assert [mutation.operand for mutation in repair.mutations] == [GAIN]
