"""What nothing in the files calls, and others do: entry points, nodes to be made, methods that a framework runs."""

from __future__ import annotations

from tarl_lint import catalog
from tarl_lint.valueflow import ir
from tarl_lint.valueflow.activations import ROOT_CALL
from tarl_lint.valueflow.execute import Execution
from tarl_lint.valueflow.starting import STARTING, definitions, registers, starts, starts_node
from tarl_lint.valueflow.store import Root
from tarl_lint.valueflow.values import ClassInfo, Obj, Value, lineage


class Uncalled(Execution):
    """Starts what is there to be started from outside."""

    def start_programs(self) -> None:
        """Run functions and make nodes that are there to be started from outside (entry points)."""
        for program in list(self.programs.values()):
            module = self.module_objects[program.name]
            starting = STARTING.search(self.modules[program.path].text) is not None
            named = self.modules[program.path].started
            for statement in definitions(program.body):
                if isinstance(statement, ir.Define):
                    function = statement.function
                    if function.name in named or (
                        (starting or function.name == "main") and starts_node(function)
                    ):
                        self._main_function(statement, module)
                elif statement.name in named:
                    self._plugin(statement, module)
                else:
                    self._node_class(statement, program, starting)

    def _main_function(self, statement: ir.Define, module: Obj) -> None:
        function = statement.function
        if (function.module, function.pos[0]) in self.called:
            return
        for obj in self._values(module, function.name):
            if obj.kind == "closure":
                self._start(obj, "main", self.programs[module.name].path)

    def _values(self, holder: Obj, name: str) -> list[Obj]:
        owners = self.shared.ends.get((holder, name), {})
        return sorted({o for v in owners.values() for o in v.pts}, key=lambda o: str(o.key))

    def _start(self, target: Obj, kind: str, path: str) -> None:
        root = Root((kind, target.kind, target.key), kind, target.name, once=True, program=path)

        def run(root: Root) -> None:
            self.call_object(target, ([], {}), self.root_frame(root), ROOT_CALL)

        self.add_root(root, run)

    def _plugin(self, statement: ir.Class, module: Obj) -> None:
        """Make an instance of a class that a package names for others to make."""
        for cls in self._values(module, statement.name):
            if cls.kind == "class" and (cls in self.plugins or cls.key not in self.made):
                self._start(cls, "node", self.programs[module.name].path)
                self.plugins.add(cls)

    def _node_class(self, statement: ir.Class, program: ir.Program, starting: bool) -> None:
        """Make an instance of a class that registers something, or is a node, and that nothing instantiates."""
        for cls in self._values(self.module_objects[program.name], statement.name):
            if cls.kind != "class" or cls.key in self.made:
                continue
            wanted = (
                not self._has_made_heir(cls) if starting and registers(statement) else self._last_node(cls)
            )
            if wanted:
                self._start(cls, "node", program.path)
                self.guests.add(cls)

    def _last_node(self, cls: Obj) -> bool:
        """Tell whether a class is a node by what it inherits, and nothing inherits from it."""
        if not isinstance(cls.info, ClassInfo) or _external(cls.info).isdisjoint(catalog.NODES):
            return False
        return not any(
            o.kind == "class" and o is not cls and cls in lineage(o) for o in self.objects.values()
        )

    def _has_made_heir(self, cls: Obj) -> bool:
        return any(cls in lineage(self.objects["class", key]) for key in self.made)

    def start_hooks(self) -> None:
        """Run methods that a base class of a library may call: nothing in the files tells when."""
        for obj in list(self.objects.values()):
            if obj.kind != "instance" or not isinstance(obj.info, Obj):
                continue
            for owner in lineage(obj.info):
                if isinstance(owner.info, ClassInfo) and owner.info.statement is not None:
                    self._framework_methods(obj, owner, owner.info)

    def _framework_methods(self, obj: Obj, owner: Obj, info: ClassInfo) -> None:
        cls = obj.info.info if isinstance(obj.info, Obj) else None
        external = _external(cls) if isinstance(cls, ClassInfo) else set()
        unknown = external - catalog.NODE_BASES or self._called_by_others(obj, info)
        for statement in info.statement.body if info.statement is not None else ():
            if not isinstance(statement, ir.Define):
                continue
            name, function = statement.function.name, statement.function
            hooked = (unknown and not name.startswith("_")) or (external and name.startswith("on_"))
            hooked = hooked or (name == "run" and any("Thread" in e for e in external))
            if not hooked or (function.module, function.pos[0]) in self.called:
                continue
            for closure in self._values(owner, name):
                if closure.kind == "closure":
                    state = name == catalog.RUNS_STATE and any(e.startswith(catalog.STATES) for e in external)
                    self._start_method(closure, obj, owner, [self.userdata(obj)] if state else [])

    def _called_by_others(self, obj: Obj, info: ClassInfo) -> bool:
        """Tell whether whoever made an object calls its methods: of plugins, and where nothing else registers."""
        return obj.info in self.plugins or (obj.info in self.guests and not _registers_itself(info))

    def _start_method(self, closure: Obj, obj: Obj, owner: Obj, given: list[Value]) -> None:
        method = self.intern("bound", (closure.key, obj), closure.name)
        method.info = (closure, obj, owner)
        program = closure.info[2].path if isinstance(closure.info, tuple) else ""
        self.call_when("framework", method, given, "callback", program=program)


def _registers_itself(info: ClassInfo) -> bool:
    """Tell whether a class registers all it needs when it is made; else somebody calls a method for that."""
    body = info.statement.body if info.statement is not None else ()
    return any(
        isinstance(s, ir.Define) and s.function.name == "__init__" and starts(s.function) for s in body
    )


def _external(info: ClassInfo) -> set[str]:
    found = set(info.external)
    for base in info.bases:
        if isinstance(base.info, ClassInfo):
            found |= _external(base.info)
    return found
