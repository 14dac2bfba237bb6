"""Score the call resolver on PyCG's micro-benchmark: `python benchmarks/lint_pycg.py CHECKOUT`.

CHECKOUT is a checkout of github/vitsalis/PyCG, which has small programs with their true calls. As in PyCG, a result is
*sound* if no call of a program is missed, and *complete* if no wrong call is reported. PyCG itself runs on the same
programs, from the same checkout. For both tools, only calls between functions of the programs count, not those of
builtins and libraries. As in PyCG, functions that nothing calls are entry points.

The true calls were written by hand. With `--run`, each program with a missing call is executed, to print how many of
the missing calls Python really makes.
"""

from __future__ import annotations

import argparse
import ast
import json
import subprocess
import sys
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from pathlib import Path

from tarl_lint.interpret import call_contexts, calls, worklist
from tarl_lint.interpret.call_contexts import ROOT_CALL
from tarl_lint.interpret.fixpoint import Linker
from tarl_lint.memory import heap
from tarl_lint.memory.frames import Frame
from tarl_lint.memory.shared import Root
from tarl_lint.memory.values import Obj, pointer
from tarl_lint.read.source import Module, parse
from tarl_lint.settings.config import Config

SNIPPETS = Path("micro-benchmark/snippets")

Edge = tuple[str, str]  # caller and callee (dotted names)
# run main.py, and print file, line and name of caller and callee for each call between functions in the folder
TRACED = """
import json, os, runpy, sys

folder, made = os.getcwd(), set()

def place(frame):
    return frame.f_code.co_filename, frame.f_code.co_firstlineno, frame.f_code.co_name

def profile(frame, event, argument):
    caller = frame.f_back
    while caller is not None and caller.f_code.co_filename == "<string>":
        caller = caller.f_back  # code of eval
    both = [place(one) for one in (caller, frame) if one is not None]
    if event == "call" and len(both) == 2 and all(path.startswith(folder) for path, *_ in both):
        made.add(tuple(both))

sys.path.insert(0, folder)
sys.setprofile(profile)
try:
    runpy.run_path(os.path.join(folder, "main.py"), run_name="__main__")
except Exception:
    pass
sys.setprofile(None)
print(json.dumps(sorted(made)))
"""


class Calls(Linker):
    """Record the caller and callee of every call."""

    def __init__(self, modules: Sequence[Module]) -> None:
        super().__init__(modules, Config())
        self.names = {m.path: dict(function_names(m)) for m in modules}

    def name(self, frame: Frame) -> str:
        """Return the dotted name of a frame's function."""
        path, function = frame.program.path, frame.function
        module = self.modules[path].name
        if function is frame.program.function:
            return module
        inner = self.names[path].get((function.pos[0], function.pos[1]), "")
        return f"{module}.{inner}" if inner else module

    def edges(self) -> set[Edge]:
        """Return all calls between functions of the analysed files."""
        frames = [f for f in self.frames.values() if f.caller is not None and _own(f.caller)]
        return {(self.name(f.caller), self.name(f)) for f in frames if f.caller is not None}

    def start_rest(self) -> None:
        """Run functions that nothing calls, with unknown arguments, until every function has run."""
        started: set[Obj] = set()
        while True:
            rest = [
                o
                for o in self.objects.values()
                if o.kind == "closure" and o not in started and not self._runs(o)
            ]
            if not rest:
                return
            for closure in rest:
                started.add(closure)
                self._begin(closure)
            self._settle()

    def _runs(self, closure: Obj) -> bool:
        function = closure.info[0] if isinstance(closure.info, tuple) else None
        return function is None or (function.module, function.pos[0]) in self.called

    def _begin(self, closure: Obj) -> None:
        owner = closure.info[3] if isinstance(closure.info, tuple) else None

        def run(root: Root) -> None:
            frame = worklist.root_frame(self, root)
            target = closure
            if isinstance(owner, Obj):
                (made,) = call_contexts.instantiate(self, owner, ([], {}), frame, ROOT_CALL).pts
                (target,) = heap.bind(self, pointer(closure), made, owner).pts
            calls.call_object(self, target, ([], {}), frame, ROOT_CALL)

        root = Root(("rest", closure.key), "rest", closure.name, once=True)
        worklist.add_root(self, root, run)


def _own(frame: Frame) -> bool:
    """Return whether a frame belongs to the analysed files, not to the interpreter."""
    return not (isinstance(frame.key, tuple) and frame.key[0] == "root")


def function_names(module: Module) -> Iterator[tuple[tuple[int, int], str]]:
    """Yield start (line, column) and dotted name of each function; lambdas are numbered in their scope."""
    pending: list[tuple[ast.AST, str]] = [(module.tree, "")]
    counts: Counter[str] = Counter()
    while pending:
        node, scope = pending.pop(0)
        for child in ast.iter_child_nodes(node):
            inner = scope
            if isinstance(child, (ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef)):
                inner = f"{scope}.{child.name}".lstrip(".")
            elif isinstance(child, ast.Lambda):
                counts[scope] += 1
                inner = f"{scope}.<lambda{counts[scope]}>".lstrip(".")
            if inner != scope and not isinstance(child, ast.ClassDef):
                yield (child.lineno, child.col_offset), inner  # type: ignore[attr-defined]
            pending.append((child, inner))


def ours(folder: Path) -> set[Edge]:
    """Return the calls that the resolver finds in a program."""
    modules = []
    for path in sorted(folder.rglob("*.py")):
        parts = path.relative_to(folder).with_suffix("").parts
        package = parts[-1] == "__init__"
        name = ".".join(parts[:-1] if package and len(parts) > 1 else parts)
        module = parse(str(path), path.read_bytes(), name)
        if isinstance(module, Module):
            modules.append(replace(module, is_package=package))
    calls = Calls(modules)
    calls.link()
    calls.start_rest()
    return calls.edges()


def theirs(folder: Path) -> set[Edge]:
    """Return the calls that PyCG finds in a program, in a separate process because it changes the import system."""
    checkout = folder.parents[len(SNIPPETS.parts) + 1]
    command = [sys.executable, "-m", "pycg", "--package", str(folder), str(folder / "main.py")]
    done = subprocess.run(command, cwd=checkout, capture_output=True, text=True, check=False)
    graph = json.loads(done.stdout) if done.returncode == 0 else {}
    return {(caller, callee) for caller, callees in graph.items() for callee in callees}


def executed(folder: Path) -> set[Edge]:
    """Return the calls that Python makes when running a program, in a separate process."""
    done = subprocess.run(
        [sys.executable, "-c", TRACED], cwd=folder, capture_output=True, text=True, check=True, timeout=60
    )
    names: dict[tuple[str, int], str] = {}
    for path in sorted(folder.rglob("*.py")):
        module = parse(str(path), path.read_bytes(), ".".join(path.relative_to(folder).with_suffix("").parts))
        if isinstance(module, Module):
            own = {line: f"{module.name}.{inner}" for (line, _), inner in function_names(module)}
            names |= {(str(path), line): name for line, name in own.items()}
            for node in ast.walk(module.tree):
                if isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef)) and node.decorator_list:
                    # a decorated function's code object starts at its first decorator
                    names[str(path), node.decorator_list[0].lineno] = own[node.lineno]
            names[str(path), 0] = module.name

    def dotted(path: str, line: int, name: str) -> str:
        return names.get((path, 0 if name == "<module>" else line), name)

    return {(dotted(*caller), dotted(*callee)) for caller, callee in json.loads(done.stdout.splitlines()[-1])}


def inner_calls(edges: set[Edge], folder: Path) -> set[Edge]:
    """Return the calls whose callee is a function of the program."""
    names = {p.relative_to(folder).parts[0].removesuffix(".py") for p in folder.rglob("*.py")}
    return {(a, b) for a, b in edges if b.partition(".")[0] in names}


def main(arguments: Sequence[str] | None = None) -> None:
    """Print TARL's shares next to PyCG's."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("checkout", type=Path, help="checkout of github/vitsalis/PyCG")
    parser.add_argument("--details", action="store_true", help="list all missing and invented calls")
    parser.add_argument(
        "--run",
        action="store_true",
        help="execute each program with a missing call, to see whether Python makes this call",
    )
    options = parser.parse_args(arguments)
    options.checkout = options.checkout.resolve()
    programs = sorted((options.checkout / SNIPPETS).glob("*/*/callgraph.json"))
    if not programs:
        sys.exit(
            f"{options.checkout / SNIPPETS} contains no programs: name a checkout of github/vitsalis/PyCG."
        )
    print(f"{len(programs)} programs{'':>14}{'sound':>10}{'complete':>10}{'calls found':>13}{'invented':>10}")
    for name, tool in (("tarl-lint", ours), ("PyCG", theirs)):
        total = score(programs, tool, details=options.details, run=options.run)
        shown = f"{total['found']}/{total['calls']}"
        print(f"{name:>26}{total['sound']:>10}{total['complete']:>10}{shown:>13}{total['invented']:>10}")
        if options.run:
            missing = total["calls"] - total["found"]
            print(f"{'':>26}  Python makes {total['made']} of the {missing} missing calls")


def score(
    programs: Sequence[Path], tool: Callable[[Path], set[Edge]], *, details: bool, run: bool = False
) -> Counter[str]:
    """Compare the calls that a tool finds in each program with the true ones."""
    total: Counter[str] = Counter()
    for path in programs:
        folder = path.parent
        graph = json.loads(path.read_text(encoding="utf-8"))
        wanted = inner_calls({(a, b) for a, callees in graph.items() for b in callees}, folder)
        found = inner_calls(tool(folder), folder)
        missing, invented = wanted - found, found - wanted
        total.update(sound=not missing, complete=not invented, calls=len(wanted), found=len(wanted & found))
        total["invented"] += len(invented)
        if missing and run:
            total["made"] += len(missing & executed(folder))
        if details and (missing or invented):
            print(f"    {tool.__name__} {folder.parent.name}/{folder.name}:")
            print(f"        missing {sorted(missing)}, invented {sorted(invented)}")
    return total


if __name__ == "__main__":
    main()
