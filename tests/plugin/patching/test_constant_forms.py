"""A constant in any notation is an operand, is found by the sweep, and is changed at its definition."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from pytest_tarl.instrumentation.datafiles import reading
from pytest_tarl.patching.constant_definitions import Place, configured, defined, package_files, parameter
from pytest_tarl.patching.mutate import Mutation, mutations
from pytest_tarl.patching.named_numbers import named_numbers
from pytest_tarl.patching.rewriting import rewrite
from pytest_tarl.searching.accept import Outcome
from pytest_tarl.searching.candidates import ALWAYS
from pytest_tarl.searching.search import Candidate, Goal, Pair, Trials
from pytest_tarl.searching.sweep import Sweep
from tarl_lint.api import Analysis, analyse
from tarl_lint.model import Operand, SiteId, Span
from tests.plugin.patching.constants import DATA, FORMS, HERE, node
from tests.plugin.patching.repairs import TinyRos

WANTED = 5.0  # gain that the drifted world needs; the node has 2
NOWHERE = {"literal", "choice", "parameter at its use"}


class World:
    """Ten points per mission, minus the error of the published value."""

    def __init__(self, name: str, folder: Path) -> None:
        self.name, self.folder = name, folder
        texts = dict(zip(("keeper.py", "helper.py"), node(name, str(folder)), strict=True))
        for path, text in (texts | DATA).items():
            (folder / path).write_text(text)
        self.analysis: Analysis = analyse([folder], root=folder)

    def published(self, changed: Mapping[str, str]) -> float:
        """Return the value that the node sends for an input of 1, with some files changed."""
        texts = {Path(path).name: text for path, text in {**self.analysis.sources, **changed}.items()}
        overlay = {self.folder / Path(path).name: text for path, text in changed.items()}
        ros = TinyRos()
        with reading(overlay):
            ros.run({name: texts[name] for name in ("helper.py", "keeper.py")}, "keeper.py")
            ros.deliver("/in", SimpleNamespace(data=1.0))
        return float(ros.published[-1])

    def written(self, candidate: Candidate) -> dict[str, str]:
        """Return the files that a candidate changes."""
        return rewrite(self.analysis, candidate.mutations, candidate.guard, {}, DATA)

    def run(self, candidate: Candidate, seed: int) -> Outcome:
        total = 10.0 - abs(self.published(self.written(candidate)) - WANTED)
        return Outcome(total, total > 9.0)

    def place(self, mutation: Mutation) -> Place | None:
        """Return the definition of a mutation's constant, in a configuration file if it was loaded from one."""
        found = defined(self.analysis, mutation.operand)
        if len(found) == 1:
            return found[0]
        texts = {
            key: text
            for key, text in package_files(self.folder, self.folder / "keeper.py").items()
            if key == self.data
        }
        others = named_numbers(self.analysis, mutation.operand) if not found else []
        others += configured(parameter(self.analysis, mutation.operand), texts)
        return next((one for one in others if self.in_force(mutation, one)), None)

    def in_force(self, mutation: Mutation, place: Place) -> bool:
        """Return whether a change of a number alters what the node sends."""
        return self.published(self.written(Candidate((replace(mutation, place=place),), ALWAYS))) != 2.0

    @property
    def data(self) -> str:
        return FORMS[self.name].get("data", "")


@pytest.mark.parametrize("name", FORMS)
def test_constant_is_changed_where_it_is_defined(name: str, tmp_path: Path) -> None:
    world = World(name, tmp_path)
    assert world.published({}) == pytest.approx(2.0)
    operands = [one for step in world.analysis.sites for one in world.analysis.operands(step.site)]
    pairs = tuple(Pair(seed, 7.0) for seed in range(3))
    goal = Goal(pairs, near=9.0, enough=9.0, online=7.0)
    search = Sweep(operands, mutations, (ALWAYS,), Trials(world.run, 30), goal)
    found = next(search.candidates())
    (mutation,) = found.mutations
    place = world.place(mutation)
    if name in NOWHERE:
        assert place is None
        return
    assert place is not None
    moved = Candidate((replace(mutation, place=place),), ALWAYS)
    assert world.published(world.written(moved)) == pytest.approx(
        world.published(world.written(found)), rel=1e-3
    )
    ((path, text),) = world.written(moved).items()
    before = {**world.analysis.sources, **DATA}[path].split("\n")
    changed = [line for line, old in zip(text.split("\n"), before, strict=True) if line != old]
    assert len(changed) == 1
    assert HERE in changed[0] or path.endswith(".json")


def test_a_number_in_quotes_is_changed_inside_them() -> None:
    text = 'parser.add_argument("--gain", type=float, default="2.0")\nspeed = args.gain\n'
    analysis: Any = SimpleNamespace(sources={"keeper.py": text})
    use = Operand(
        SiteId("keeper", "", "speed = args.gain"), Span("keeper.py", 2, 9, 2, 18), "args.gain", None
    )
    (place,) = named_numbers(analysis, use)
    assert text[place.start - 1 : place.end + 1] == '"2.0"'
