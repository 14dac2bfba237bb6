"""Score the analysis on CodeQL's own data-flow tests: `python benchmarks/lint_codeql.py CHECKOUT`.

CHECKOUT is a checkout of github/codeql, of which only python/ql/test/library-tests/dataflow is read. In these tests,
the variable SOURCE and a few literals are sources; arguments of SINK and SINK_F are sinks. Comments say which flows
exist (`flow=`), which of these CodeQL misses (`MISSING`), and which reported flows do not exist (`SPURIOUS`). For TARL,
the variable is replaced by a call of a configured source, and the two functions are configured as sinks. A file is
scored only if CodeQL uses it to test plain data flow, and if it needs no models of library functions.
"""

from __future__ import annotations

import argparse
import ast
import re
import sys
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from tarl_lint import engine
from tarl_lint.flows.reachability import Tracer
from tarl_lint.interpret.fixpoint import Linker
from tarl_lint.interpret.interpreter import Interpreter
from tarl_lint.ir.nodes import Expr, Pos, Stmt
from tarl_lint.memory import reachable_data
from tarl_lint.memory.frames import Frame
from tarl_lint.memory.values import Value
from tarl_lint.read.source import Module, parse
from tarl_lint.settings.config import Config

TESTS = Path("python/ql/test/library-tests/dataflow")
QUERY = "NormalDataflowTest.ql"
NEED_MODELS = ("model-summaries", "summaries")
DEFINED = ("SOURCE", "SINK", "SINK_F")
IMPORT = "from codeql_suite import ANY, SOURCE, SINK, SINK_F"
SETTINGS = Config(sources=("codeql_suite.SOURCE",), sinks=("codeql_suite.SINK", "codeql_suite.SINK_F"))
COMMENT = re.compile(
    r"(?P<how>MISSING:|SPURIOUS:)|flow=(?P<quote>[\"'])(?P<what>.*?)(?:, l:?(?P<offset>[-+]?\d+))? -> .*?(?P=quote)"
    r"|(?P<bare>\bflow\b(?!=))"
)
ANY = 0  # any line, because the comment does not give the source's line

Pair = tuple[int, int]  # lines of source and sink


@dataclass
class Expected:
    """The flows according to a file's comments: those that CodeQL finds, misses and reports wrongly."""

    found: set[Pair] = field(default_factory=set)
    missed: set[Pair] = field(default_factory=set)
    invented: set[Pair] = field(default_factory=set)
    literals: dict[int, set[str]] = field(default_factory=dict)

    @property
    def real(self) -> set[Pair]:
        """Return the real flows."""
        return self.found | self.missed


def expected(text: str) -> Expected:
    """Read the comments of a test file."""
    result = Expected()
    for number, line in enumerate(text.split("\n"), 1):
        _, marker, comment = line.partition("# $")
        into = result.found
        told: set[Pair] = set()
        for match in COMMENT.finditer(comment if marker else ""):
            if match["how"]:
                into = result.missed if match["how"] == "MISSING:" else result.invented
                continue
            if match["bare"] and told:
                continue  # repeats, on another path, a flow that CodeQL finds
            source = ANY if match["bare"] else number + int(match["offset"] or 0)
            into.add((source, number))
            told.add((source, number))
            if source != ANY and match["what"] != "SOURCE":
                result.literals.setdefault(source, set()).add(match["what"])
    return result


def prepared(text: str, wanted: Expected) -> str:
    """Return the file with calls as sources, without its definitions of sources and sinks, and with added calls.

    The added calls, at the end, call the test functions. Line numbers stay the same.
    """
    tree = ast.parse(text)
    lines = text.split("\n")
    edits = [
        (n.end_lineno or 0, n.end_col_offset or 0, n.col_offset, "SOURCE()") for n in _sources(tree, wanted)
    ]
    for line, end, start, new in sorted(edits, reverse=True):
        lines[line - 1] = lines[line - 1][:start] + new + lines[line - 1][end:]
    defined = [n for n in tree.body if set(_names(n)) & {*DEFINED, "is_source"}]
    for node in defined:
        lines[node.lineno - 1 : node.end_lineno] = [""] * ((node.end_lineno or node.lineno) - node.lineno + 1)
    opening = tree.body[0]
    if defined:
        lines[defined[0].lineno - 1] = IMPORT
    elif isinstance(opening, (ast.Expr, ast.Assign, ast.Import, ast.ImportFrom)):
        lines[opening.lineno - 1] = f"{IMPORT}; {lines[opening.lineno - 1]}"
    else:
        lines.append(IMPORT)
    return "\n".join([*lines, *_calls(tree)])


def _sources(tree: ast.Module, wanted: Expected) -> Iterator[ast.expr]:
    for node in ast.walk(tree):
        named = isinstance(node, ast.Name) and node.id == "SOURCE" and isinstance(node.ctx, ast.Load)
        literals = wanted.literals.get(getattr(node, "lineno", 0), set())
        if isinstance(node, ast.expr) and (
            named or (isinstance(node, ast.Constant) and ast.unparse(node) in literals)
        ):
            yield node


def _names(node: ast.stmt) -> Iterator[str]:
    """Yield the names that a module's statement defines."""
    if isinstance(node, (ast.FunctionDef, ast.ClassDef)):
        yield node.name
    elif isinstance(node, ast.Assign):
        yield from (t.id for t in node.targets if isinstance(t, ast.Name))


def _calls(tree: ast.Module) -> Iterator[str]:
    """Yield calls of the functions and methods that contain a sink, with default and with unknown arguments."""
    for node in tree.body:
        if isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef)) and _sinks(node):
            yield f"{node.name}()"
            if node.args.args:
                yield f"{node.name}({_anything(node, 0)})"
        elif isinstance(node, ast.ClassDef):
            for method in node.body:
                if isinstance(method, ast.FunctionDef) and _sinks(method):
                    yield f"{node.name}().{method.name}({_anything(method, 1)})"


def _sinks(function: ast.AST) -> bool:
    return any(isinstance(n, ast.Name) and n.id in DEFINED for n in ast.walk(function))


def _anything(function: ast.FunctionDef | ast.AsyncFunctionDef, receivers: int) -> str:
    """Return unknown arguments for all parameters, including those with defaults."""
    return ", ".join(["ANY"] * (len(function.args.args) - receivers))


def found(text: str, name: str) -> tuple[set[Pair], set[Pair]]:
    """Return a prepared file's explicit flows, and those in which the value itself reaches the sink.

    In the other flows, a list or object that contains the value reaches the sink. This counts as a flow for a publish
    call, but not for CodeQL's sinks.
    """
    module = parse(f"{name}.py", text.encode(), name)
    if not isinstance(module, Module):
        return set(), set()
    machine, flows = engine.trace([module], SETTINGS)
    own = [f for f in flows if f.kind == "explicit" and f.sink.span.path == module.path == f.source.span.path]
    return {(f.source.span.line, f.sink.span.line) for f in own}, _bare(machine)


def _bare(machine: Linker) -> set[Pair]:
    """Return the flows whose value is not inside a list, mapping or object."""
    tracer = Tracer(machine)
    reached = [(record.pos[0], tracer.reach(record).data) for record in machine.sources.values()]
    pairs: set[Pair] = set()

    def look(machine: Interpreter, frame: Frame, statement: Stmt, expr: Expr, value: Value) -> None:  # noqa: ARG001
        sinks = [s for s in machine.sinks.values() if _argument_of(expr.pos, s.pos)]
        if not sinks:
            return
        loose = frozenset(o for o in value.pts if o.kind not in ("sequence", "mapping", "instance", "class"))
        nodes = value.deps | reachable_data.deep(machine, loose)
        pairs.update((line, s.pos[0]) for s in sinks for line, reach in reached if nodes & reach)

    machine.probe = look
    machine.replay()
    return pairs


def _argument_of(pos: Pos, call: Pos) -> bool:
    """Return whether an expression is a call's last argument, or the last part of it."""
    return pos != call and (pos[0], pos[2], pos[3] + 1) == (call[0], call[2], call[3])


def main(arguments: Sequence[str] | None = None) -> None:
    """Print the flows found in each file, then TARL's shares next to CodeQL's."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("checkout", type=Path, help="checkout of github/codeql")
    parser.add_argument("--details", action="store_true", help="list all missed and invented flows")
    options = parser.parse_args(arguments)
    folder = options.checkout / TESTS
    if not folder.is_dir():
        sys.exit(f"{folder}: no such folder; name a checkout of github/codeql.")
    total: Counter[str] = Counter()
    for query in sorted(folder.rglob(QUERY)):
        if query.parent.name in NEED_MODELS:
            continue
        for path in sorted(query.parent.glob("*.py")):
            score(path, folder, options.details, total)
    print(summary(total))


def score(path: Path, folder: Path, details: bool, total: Counter[str]) -> None:
    """Score one file and print the differences."""
    text = path.read_text(encoding="utf-8")
    wanted = expected(text)
    try:
        ready = prepared(text, wanted)
    except SyntaxError:
        print(f"{path.relative_to(folder)}: left out, because it is not valid in this version of Python")
        return
    if "SINK" not in text:
        return
    every, bare = found(ready, path.stem)
    pairs = {(ANY if (ANY, sink) in wanted.real else source, sink) for source, sink in every}
    missed, wrong = wanted.real - pairs, pairs - wanted.real
    invented, inside = wrong & bare, wrong - bare
    total.update(real=len(wanted.real), ours=len(wanted.real & pairs), theirs=len(wanted.found))
    total.update({"our false": len(invented), "inside": len(inside), "their false": len(wanted.invented)})
    print(
        f"{path.relative_to(folder)}: {len(wanted.real & pairs)} of {len(wanted.real)}, {len(invented)} false"
    )
    lines = text.split("\n")
    for word, which in (("missed", missed), ("invented", invented), ("inside", inside)):
        for source, sink in sorted(which if details else ()):
            start = lines[source - 1].strip() if source != ANY else "a source"
            print(f"    {word} {source} → {sink}: {start} … {lines[sink - 1].strip()}")


def summary(total: Counter[str]) -> str:
    """Return TARL's shares next to CodeQL's."""
    real = total["real"] or 1
    return "\n".join(
        [
            "",
            f"{'':>22}{'found':>14}{'false':>8}",
            f"{'tarl-lint':>22}{total['ours']:>7} ({total['ours'] / real:.1%}){total['our false']:>6}",
            f"{'CodeQL':>22}{total['theirs']:>7} ({total['theirs'] / real:.1%}){total['their false']:>6}",
            f"{'real flows':>22}{total['real']:>7}",
            f"Not counted as false: {total['inside']} sinks that receive a list or object which contains the value.",
        ]
    )


if __name__ == "__main__":
    main()
