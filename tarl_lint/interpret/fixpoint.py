"""Worklist fixpoint over the roots: modules, callbacks, timers, threads and entry points."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from tarl_lint.interpret import entry_points, statements, wiring
from tarl_lint.interpret.budget import (
    IRRELEVANT_CALL_LIMIT,
    LARGE_RUN,
    LATE_RUN_LIMIT,
    MAX_ROUNDS,
    MAX_STATEMENTS,
    PROGRAM_LIMIT,
)
from tarl_lint.interpret.interpreter import Interpreter
from tarl_lint.ir import nodes as ir
from tarl_lint.ir.lower_statements import lower_module
from tarl_lint.memory import carry_nodes, joins
from tarl_lint.memory.frames import Frame
from tarl_lint.memory.shared import Root
from tarl_lint.memory.store import Store
from tarl_lint.memory.value_flow_graph import MAX_EDGES
from tarl_lint.memory.values import ABSENT, BOTTOM, Obj, Value
from tarl_lint.models import states_and_behaviours
from tarl_lint.models.ros import registered_roots
from tarl_lint.prefilter.by_words import endpoint_words
from tarl_lint.read.source import Module
from tarl_lint.settings.config import Config


class Linker(Interpreter):
    """Runs roots until the shared memory is stable."""

    def __init__(
        self,
        modules: Sequence[Module],
        config: Config,
        failures: dict[str, Exception] | None = None,
        *,
        thorough: bool = True,
    ) -> None:
        """If `failures` is given, store each exception there under its file and continue; otherwise raise it.

        Unless `thorough`, ignore values that do not come from a source, since flows do not need them.
        """
        super().__init__(modules, config, wiring)
        self.thorough = thorough
        self.took: dict[Root, int] = {}  # statements in the last run of each root
        self.failures = failures
        has_word = endpoint_words(config)
        part = {m.path for m in modules if len(modules) == 1 or m.answer(has_word)}
        for module in modules:
            program = self._lowered(module)
            if program is None:
                continue
            program.takes_part = module.path in part
            key = module.name if module.name not in self.programs else module.path
            program.name = key
            self.programs[key] = self.by_path[program.path] = program
            self.module_objects[key] = Obj("module", key, key)

    def _lowered(self, module: Module) -> ir.Program | None:
        try:
            return lower_module(module)
        except Exception as error:
            self._failed(module.path, error)
            return None

    def _failed(self, path: str, error: Exception) -> None:
        if self.failures is None:
            raise error
        self.failures.setdefault(path, error)

    def link(self) -> None:
        """Run all roots to the fixpoint."""
        for program in self.programs.values():
            self._module_root(program)
        self._settle()
        for _ in range(3):
            before = len(self.roots)
            entry_points.start_functions(self)
            self._settle()
            entry_points.start_classes(self)
            self._settle()
            entry_points.start_hooks(self)
            self._settle()
            if states_and_behaviours.connect(self):
                self._settle()
            if len(self.roots) == before:
                break
        if self.waiting:  # roots store nothing new any more, so values that are unknown now stay unknown
            self.patient = False
            self.pending.update(self.waiting)
            self._settle()
        # a new condition may add outcomes; repeat until no part gets a new outcome
        while states_and_behaviours.connect(self):
            self._settle()
        carry_nodes.settle(self.graph)
        registered_roots.connect(self)
        self._forget_runs()

    def _forget_runs(self) -> None:
        """Before flows are traced, drop the records of finished calls, which only the fixpoint needs."""
        for frame in self.frames.values():
            frame.recorded = None
        self.graph.forget_arrivals()

    def replay(self) -> None:
        """Run every root once more under a probe, which observes it."""
        for root, run in list(self.roots.values()):
            self._run(root, run)

    # --- roots --------------------------------------------------------------------------------------------

    def _settle(self) -> None:
        for _ in range(MAX_ROUNDS):
            self._reconsider()
            batch = sorted(self.pending, key=self._turn)
            if not batch:
                return
            small = [root for root in batch if self.took.get(root, 0) < LARGE_RUN]
            for root in small or batch:
                self.pending.pop(root, None)
                program = self.work.charged_to(root.program)
                late = self.hurried(root.program)
                if late and (
                    self.took.get(root, 0) > LATE_RUN_LIMIT
                    or self.work.totals.get(program, 0) > 2 * PROGRAM_LIMIT
                ):
                    continue
                self._run(root, self.roots[root.key][1])
                for news in self.shared.dirty:
                    self.pending[news] = None
                self.shared.dirty.clear()

    def _turn(self, root: Root) -> tuple[int, int, int]:
        """Return the priority of a root: new modules, then callbacks, then modules to re-run, each cheapest first."""
        took = self.took.get(root)
        return 1 if root.kind != "module" else 0 if took is None else 2, took or 0, root.number

    def _reconsider(self) -> None:
        """Queue the roots that ignored an unreached node which a source reaches now."""
        for node in [n for n in self.doubts if n in self.graph.live]:
            self.pending.update(self.doubts.pop(node))

    def _run(self, root: Root, run: Callable[[Root], None]) -> None:
        self.store = Store(self.shared, root, gather=self.gathered)
        self.graph.reads = self.store.reads
        self.stack, self.building = [], []
        program = self.work.charged_to(root.program)
        self.work.begin(LATE_RUN_LIMIT if self.hurried(root.program) else MAX_STATEMENTS)
        self.graph.edges = self.work.edges_of.get(root.program, 0)
        self.graph.made = self.work.nodes_of.get(root.program, 0)
        self.delivered, self.opened = frozenset(), []
        try:
            run(root)
        except Exception as error:
            where = self.stack[-1].program if self.stack else next(iter(self.programs.values()))
            self._failed(where.path, error)
            return
        finally:
            self.work.totals[program] = self.work.totals.get(program, 0) + self.work.charged
            self.work.edges_of[root.program] = self.graph.edges
            self.work.nodes_of[root.program] = self.graph.made
            if self.graph.edges >= MAX_EDGES:
                self.cut[program] = None
            self.took[root] = self.work.spent
        for key in self.store.own():
            value = self._at_end(key)
            value = self.store.mine(key, value) if value is not None else None
            if value is not None:
                self.shared.leave(self.shared.ends, root, key, value)

    def _at_end(self, key: tuple[Obj, str]) -> Value | None:
        value = self.store.now.get(key)
        if value is ABSENT:
            value = BOTTOM if key[1] == "*" else self.ops.default(self, *key)
            return None if value is BOTTOM else value
        return value

    def _module_root(self, program: ir.Program) -> None:
        root = Root(("module", program.path), "module", program.name, once=True, program=program.path)

        def run(root: Root) -> None:  # noqa: ARG001 - shared signature
            key = ("module", program.path)
            frame = self.frames.get(key)
            if frame is None:
                module = self.module_objects[program.name]
                frame = Frame(key, len(self.frames) + 1, program.function, program, module)
                self.frames[key] = frame
            frame.root_waits = True
            frame.escapes = []
            self.stack.append(frame)
            if not program.takes_part:
                self.work.call_limit = IRRELEVANT_CALL_LIMIT + len(program.body)
            statements.run(self, frame)
            # callbacks may still run when `sys.exit(app.exec_())` or another exception ends the module
            if frame.escapes:
                joins.merge(self, [{}, *{id(e.state): e.state for e in frame.escapes}.values()])

        self.ops.add_root(self, root, run)
