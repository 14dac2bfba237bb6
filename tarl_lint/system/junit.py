"""JUnit XML of systems: a test case for each hazard of a file, and a passed case for each flow of a launch file."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from tarl_lint.files import shown
from tarl_lint.report.junit import Case, cases, written
from tarl_lint.report.line import ASCII, Line, View, plain
from tarl_lint.run.runner import Result
from tarl_lint.system.chain_lines import in_line, statements
from tarl_lint.system.flow_chains import chains
from tarl_lint.system.model import Chain, System

_VIEW = View(glyphs=ASCII, show_paths=True)


def report(systems: Sequence[System], result: Result, origin: str = "", target: str = "") -> Iterator[Line]:
    """Yield the document. Flows across nodes never fail; their text is the statements in each node."""
    flows = (_case(system, chain) for system in systems for chain in chains(system.hops, origin, target)[0])
    yield from written([*cases(result), *flows])


def _case(system: System, chain: Chain) -> Case:
    text = [in_line(chain, ASCII), *statements(chain, _VIEW)]
    name = f"flow {plain(text[0])}"
    return Case(shown(system.file), name, "passed", "", "\n".join(map(plain, text)))
