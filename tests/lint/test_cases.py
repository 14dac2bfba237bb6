"""Every marked file in tests/cases has the flows in its comments, and no others.

The comment `# source a` marks a subscription (or the call that supplies its callback), `# sink a ~b` a publish call
that a reaches explicitly and b implicitly, and `# clean` one that nothing reaches. In files with `# step a ~b`,
exactly the marked lines are steps: a's data passes through the line, and for b the line is a condition.
"""

import re
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import pytest

from tarl_lint.api import analyse
from tarl_lint.model import Flow

CASES = Path(__file__).parent.parent / "cases"
MARK = re.compile(r"# (source|sink|clean)((?: ~?\w+)*)")
STEP = re.compile(r"# step((?: ~?\w+)+)")
PLAIN = frozenset(["callbacks.py"])  # files without a clean line


def units(directory: Path) -> Iterator[Path]:
    """Yield the units of analysis: a single file, or all files below a package or workspace directory."""
    for path in sorted(directory.iterdir()):
        if path.suffix == ".py":
            yield path
        elif path.is_dir() and path.name != "__pycache__":
            group = not (path / "__init__.py").exists() and any(path.glob("*.py"))
            yield from units(path) if group else [path]


UNITS = list(units(CASES))
STEPPED = [unit for unit in UNITS if unit.is_file() and "# step" in unit.read_text()]


def marks(
    unit: Path,
) -> tuple[dict[tuple[str, int], str], set[tuple[str, str, int, str]], set[tuple[str, int]]]:
    sources: dict[tuple[str, int], str] = {}
    flows: set[tuple[str, str, int, str]] = set()
    clean: set[tuple[str, int]] = set()
    for file in sorted(unit.rglob("*.py")) if unit.is_dir() else [unit]:
        for number, line in enumerate(file.read_text().splitlines(), 1):
            for kind, names in MARK.findall(line):
                for name in names.split() or [""]:
                    if kind == "source":
                        sources[file.name, number] = name
                    elif kind == "sink":
                        word = "implicit" if name.startswith("~") else "explicit"
                        flows.add((name.lstrip("~"), file.name, number, word))
                    else:
                        clean.add((file.name, number))
    return sources, flows, clean


@cache
def flows_of(unit: Path) -> tuple[Flow, ...]:
    """Return the flows of a unit, which has no errors; two tests look at most of them."""
    analysis = analyse([unit])
    assert not analysis.errors
    return analysis.flows


@pytest.mark.parametrize("unit", UNITS, ids=lambda p: p.relative_to(CASES).with_suffix("").as_posix())
def test_only_the_marked_flows_are_found(unit):
    sources, wanted, clean = marks(unit)
    assert wanted
    assert clean or unit.name in PLAIN
    found = set()
    for flow in flows_of(unit):
        place = (Path(flow.source.span.path).name, flow.source.span.line)
        source = sources.get(place, f"unmarked line {place[1]}")
        found.add((source, Path(flow.sink.span.path).name, flow.sink.span.line, flow.kind))
    missing, surplus = sorted(wanted - found), sorted(found - wanted)
    assert (missing, surplus) == ([], [])


@pytest.mark.parametrize("unit", STEPPED, ids=lambda p: p.relative_to(CASES).with_suffix("").as_posix())
def test_only_the_marked_data_steps_are_found(unit):
    sources, _, _ = marks(unit)
    marked = {
        (name, number)
        for number, line in enumerate(unit.read_text().splitlines(), 1)
        for names in STEP.findall(line)
        for name in names.split()
    }
    found: dict[str, set[tuple[str, int]]] = {"data": set(), "control": set(), "context": set()}
    for flow in flows_of(unit):
        source = sources[unit.name, flow.source.span.line]
        inner = (s for s in flow.steps if s.role not in ("publish", "receive"))
        for step in inner:
            found[step.dependence].add((source, step.span.line))
    data = {(name, line) for name, line in marked if not name.startswith("~")}
    deciding = {(name[1:], line) for name, line in marked if name.startswith("~")}
    assert found["data"] == data
    assert deciding <= found["control"]
