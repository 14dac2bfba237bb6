"""Every marked file in tests/cases gives the flows that its comments say, and no others.

`# source a` stands at a subscription (or the call that supplies its callback), `# sink a ~b` at a publish call that
a reaches explicitly and b implicitly, `# clean` at one that nothing reaches.
"""

import re
from collections.abc import Iterator
from pathlib import Path

import pytest

from tarl_lint.api import analyse

CASES = Path(__file__).parent.parent / "cases"
MARK = re.compile(r"# (source|sink|clean)((?: ~?\w+)*)")
PLAIN = frozenset(["callbacks.py"])  # has no clean line


def units(directory: Path) -> Iterator[Path]:
    """Yield what is analysed together: a file alone, or all below a directory that holds a package or workspace."""
    for path in sorted(directory.iterdir()):
        if path.suffix == ".py":
            yield path
        elif path.is_dir() and path.name != "__pycache__":
            group = not (path / "__init__.py").exists() and any(path.glob("*.py"))
            yield from units(path) if group else [path]


UNITS = list(units(CASES))


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


@pytest.mark.parametrize("unit", UNITS, ids=lambda p: p.relative_to(CASES).with_suffix("").as_posix())
def test_the_marked_flows_are_found_and_no_others(unit):
    sources, wanted, clean = marks(unit)
    assert wanted
    assert clean or unit.name in PLAIN
    analysis = analyse([unit])
    assert not analysis.errors
    found = set()
    for flow in analysis.flows:
        place = (Path(flow.source.span.path).name, flow.source.span.line)
        source = sources.get(place, f"unmarked line {place[1]}")
        found.add((source, Path(flow.sink.span.path).name, flow.sink.span.line, flow.kind))
    missing, surplus = sorted(wanted - found), sorted(found - wanted)
    assert (missing, surplus) == ([], [])
