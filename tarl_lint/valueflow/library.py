"""Calls into libraries: arguments pass to results unless something better is known."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from tarl_lint import catalog
from tarl_lint.catalog import Fact
from tarl_lint.method_effects import changes, fails, keeps_callables
from tarl_lint.valueflow import ir
from tarl_lint.valueflow.containers import CONTAINERS, QUEUES, is_device
from tarl_lint.valueflow.ends import Publisher
from tarl_lint.valueflow.frames import Frame
from tarl_lint.valueflow.futures import READERS
from tarl_lint.valueflow.handing import Handing
from tarl_lint.valueflow.heap import ANY
from tarl_lint.valueflow.invocation import Arguments, Invocation
from tarl_lint.valueflow.special import FUNCTIONS
from tarl_lint.valueflow.texts import TEXT_METHODS
from tarl_lint.valueflow.userdata import MACHINE_FIELD
from tarl_lint.valueflow.values import BOTTOM, BY_CLASS, NONE, UNKNOWN, Nodes, Obj, Value, lineage, pointer
from tarl_lint.wrapping import facts

SIGNALLING = frozenset(["connect", "emit"])


class Library(Handing):
    """Performs calls of functions, classes and methods that are not analysed."""

    def call_library(self, qualified: str, arguments: Arguments, frame: Frame, call: ir.Call) -> Value:
        """Call a function or class of a library."""
        if qualified in self.config.sanitizers:
            return UNKNOWN
        if qualified in catalog.WAITS:
            self.wait(frame)
        if qualified in self.config.sinks:
            return self.send(Invocation(qualified, BOTTOM, arguments, frame, call), Publisher(api=qualified))
        fact = self._configured(qualified) or catalog.fact(qualified)
        if fact is not None:
            return self.ros_call(Invocation(qualified, BOTTOM, arguments, frame, call, fact))
        name = qualified.removeprefix("builtins.").removeprefix("collections.")
        if name in FUNCTIONS and arguments[0]:
            said = self.special(arguments[0][0], f"__{name}__", arguments[0][1:], frame, call.pos)
            if said is not None:
                return said
        special = BUILTIN.get(name)
        if special is not None:
            return special(self, Invocation(name, BOTTOM, arguments, frame, call))
        return self.generic(qualified, arguments, frame, call)

    def _configured(self, qualified: str) -> Fact | None:
        """Return what the settings say of a function: a source subscribes when it is given a callback."""
        if self.config.wrappers and (fact := facts(self.config.wrappers).get(qualified)):
            return fact
        if qualified not in self.config.sources:
            return None
        return Fact("configured", qualified, (0, "topic"), (1, "type"), (-1, "callback"))

    def named_by_settings(self, target: Obj) -> str:
        """Return the qualified name of a function or method of ours that the settings speak of, else ""."""
        if not self.config.named:
            return ""
        closure = target.info[0] if target.kind == "bound" and isinstance(target.info, tuple) else target
        if closure.kind != "closure" or not isinstance(closure.info, tuple):
            return ""
        function, _, program, _ = closure.info
        qualified = f"{program.name}.{function.qualname}"
        return qualified if qualified in self.config.named else ""

    def generic(self, qualified: str, arguments: Arguments, frame: Frame, call: ir.Call) -> Value:
        """Pass the arguments on to the result; write the argument that the catalog says is written."""
        name = qualified.rpartition(".")[2]
        if (raises := fails(name)) is not None:
            self.may_fail(self.all_used(arguments), raises, frame)
        shaped = name in catalog.SHAPED and qualified not in self.config.named
        deps = self.all_used((arguments[0][1:], arguments[1]) if shaped else arguments)
        held = self.answering(arguments) if qualified not in catalog.KEEPERS else []
        if qualified not in catalog.KEEPERS:
            self.call_back(arguments, frame, call)
        if held and not keeps_callables(name):
            deps |= self.returned(held, arguments, BOTTOM, frame, call)
        written = catalog.written(qualified)
        if written is not None and written < len(arguments[0]):
            news = self.through_statement(Value(deps), frame, call)
            self.change(arguments[0][written], news, call.arguments[written:], frame)
        for keyword, expr in call.keywords:
            if keyword in catalog.WRITTEN_KEYWORDS and keyword in arguments[1]:
                news = self.through_statement(Value(deps), frame, call, keyword)
                self.change(arguments[1][keyword], news, [expr], frame)
        if catalog.scalar(qualified):
            same = qualified == "builtins.float" and len(arguments[0]) == 1
            return Value(deps, arguments[0][0].pts if same else frozenset())
        made = self.new_object(arguments, deps, frame, call, fields=name[:1].isupper())
        self.hold(made.pts, held)
        if qualified.startswith("io.") or (self.config.named and name[:1].isupper()):
            for obj in made.pts:
                obj.name = qualified  # settings may speak of its methods; from io.* comes what was written
        return made

    def new_object(
        self, arguments: Arguments, deps: frozenset[int], frame: Frame, call: ir.Call, *, fields: bool
    ) -> Value:
        """Return a new object of a library; keywords of a class are its fields."""
        obj = self.allocate("lib", frame, ("made", call.slot))
        where = pointer(obj)
        plain, named = arguments
        if fields:
            obj.info = BY_CLASS
            rest = NONE
            for value in plain:
                rest |= self.use(value)
            for name, value in named.items():
                if name in ("*", "**"):
                    rest |= self.use(value)
                else:
                    self.store.put((obj, name), value)
            deps = rest
        if deps:
            self.store.put((obj, ANY), Value(deps))
        return where

    # --- methods ------------------------------------------------------------------------------------------

    def call_method(
        self, base: Value, target: Obj | None, name: str, arguments: Arguments, frame: Frame, call: ir.Call
    ) -> Value:
        """Call a method of an object that is not a class of ours."""
        kind = target.kind if target is not None else ""
        if target is not None and kind == "lib" and f"{target.name}.{name}" in self.config.named:
            return self.call_library(f"{target.name}.{name}", arguments, frame, call)
        if name == "__new__" and kind in ("super", "class"):
            return self._blank_object(Invocation(name, base, arguments, frame, call))
        if target is not None and isinstance(target.info, Publisher) and name == "publish":
            return self.send(Invocation(name, base, arguments, frame, call), target.info)
        if target is not None and kind in ("server", "goal"):
            return self.serve(target, Invocation(name, base, arguments, frame, call))
        if name == "registerCallback" and kind in ("filter", "synchronizer"):
            return self.register_filter(target, Invocation(name, base, arguments, frame, call))
        if kind == "parameter":
            return base if name == "get_parameter_value" else UNKNOWN
        fact = catalog.METHODS.get(name)
        if fact is not None and kind not in ("sequence", "mapping"):
            return self.ros_call(Invocation(name, base, arguments, frame, call, fact))
        if name in catalog.LOGGING or name in catalog.CLOCKS:
            return UNKNOWN
        if name in catalog.WAITING_METHODS and base.consts is None:
            self.wait(frame)
        if name in catalog.MUTATORS and base.consts is None:
            self.mutate(base, name, arguments, frame, call)
            given_back = name == "setdefault" or (name == "send" and kind == "sequence")
            return self.read_any(target) if given_back and target is not None else UNKNOWN
        if name in READERS and base.pts:
            return READERS[name](self, Invocation(name, base, arguments, frame, call))
        return self._unknown_method(base, name, arguments, frame, call)

    def send(self, it: Invocation, info: Publisher) -> Value:
        """Record a sink."""
        raise NotImplementedError

    def serve(self, target: Obj, it: Invocation) -> Value:
        """Call a method of an action server or of a goal's handle."""
        raise NotImplementedError

    def register_filter(self, target: Obj | None, it: Invocation) -> Value:
        """Register a callback of message_filters."""
        raise NotImplementedError

    def _unknown_method(
        self, base: Value, name: str, arguments: Arguments, frame: Frame, call: ir.Call
    ) -> Value:
        if name == "join" and not base.pts:
            arguments = self.keys_joined(arguments, frame, call)
        self.call_back(arguments, frame, call)
        if name in SIGNALLING:
            self.signal(base, name, arguments, frame, call)
        given = self._given(base, name, arguments, frame, call)
        if (raises := fails(name)) is not None:
            self.may_fail(self.use(base) | self.all_used(arguments), raises, frame)
        learnt = self.all_used(arguments) | given
        if (
            learnt
            and base.pts
            and all(map(changeable, base.pts))
            and changes(name, dropped=dropped(frame, call))
        ):
            self._insert(base, [Value(learnt)], frame, call)
        written = catalog.METHODS_WRITING.get(name)
        if written is not None and written < len(arguments[0]):
            news = self.through_statement(Value(self.use(base) | self.all_used(arguments)), frame, call)
            self.change(arguments[0][written], news, call.arguments[written:], frame)
        if name in TEXT_METHODS and not base.pts and base.consts:
            return Value(
                self.use(base) | self.all_used(arguments), consts=self.text_of(base, name, arguments)
            )
        if name in catalog.DEVICE_READERS and base.pts and all(map(is_device, base.pts)):
            deps = self.received(base, arguments)
        else:
            deps = self.use(base) | self.all_used(arguments) | given
        if not deps and not base.pts:
            return UNKNOWN
        return self.new_object(arguments, deps, frame, call, fields=False)

    def _given(self, base: Value, name: str, arguments: Arguments, frame: Frame, call: ir.Call) -> Nodes:
        """Return the data of what callables say that an object of a library has: it may call them when it is called."""
        new = self.answering(arguments) if name not in SIGNALLING else []
        if keeps_callables(name):
            self.hold(base.pts, new)
            return NONE
        return self.returned([*self.held_by(base), *new], arguments, base, frame, call)

    # --- builtins -----------------------------------------------------------------------------------------

    def _blank_object(self, it: Invocation) -> Value:
        """Return what `object.__new__(cls)` gives."""
        classes = [o for v in it.arguments[0][:1] for o in v.pts if o.kind == "class"]
        return Value(pts=frozenset(self.blank_instance(c, it.frame, it.call) for c in classes))

    def _weak(self, it: Invocation) -> Value:
        """Return a weak reference: called, it gives what it refers to."""
        obj = self.allocate("weak", it.frame, ("made", it.call.slot))
        obj.info = it.arguments[0][0] if it.arguments[0] else UNKNOWN
        return pointer(obj)

    def _same(self, it: Invocation) -> Value:
        """Return the first argument itself."""
        return it.arguments[0][0] if it.arguments[0] else UNKNOWN

    def type_of(self, it: Invocation) -> Value:
        """Return the class of objects of ours; what a type is, is not data."""
        classes = [o.info for v in it.arguments[0][:1] for o in v.pts if o.kind == "instance"]
        found = frozenset(c for c in classes if isinstance(c, Obj))
        return Value(pts=found) if found else UNKNOWN

    def of_type(self, it: Invocation) -> Value:  # noqa: ARG002 - one signature for all
        """Return what a question about a type gives, which is not data either."""
        return UNKNOWN

    def parent(self, it: Invocation) -> Value:
        """Return what `super()` gives: the object, seen from its class on."""
        receiver = it.frame
        while receiver.owner is None and receiver.outer is not None:
            receiver = receiver.outer
        parameters = receiver.function.parameters
        this = self.store.get((receiver, parameters[0].name)) if parameters else None
        if this is None or receiver.owner is None:
            return UNKNOWN
        found = []
        for obj in this.pts:
            view = self.intern("super", (receiver.owner.key, obj))
            view.info = (receiver.owner, obj)
            found.append(view)
        return Value(pts=frozenset(found))

    def default(self, obj: Obj, name: str) -> Value:
        """Return a field to which nothing was stored, also through `super()` and of parameters."""
        if obj.kind == "super" and isinstance(obj.info, tuple):
            owner, this = obj.info
            cls = this.info if this.kind == "instance" else this
            order = lineage(cls) if isinstance(cls, Obj) else []
            after = order[order.index(owner) + 1 :] if owner in order else []
            for base in after:
                value = self.store.get((base, name))
                if value is not None:
                    return self.bind(value, this, base)
            return BOTTOM
        if obj.kind == "lib" and name == MACHINE_FIELD:
            return self.userdata()
        if obj.kind == "parameter":
            return self.store.get((obj, "value")) or UNKNOWN if name in catalog.PARAMETER_VALUES else UNKNOWN
        return super().default(obj, name)


def changeable(obj: Obj) -> bool:
    """Tell whether an object of a library may be changed by its methods: a node's own methods are ROS's."""
    return obj.kind == "lib" and not (isinstance(obj.key, tuple) and obj.key[:1] == ("inherited",))


def dropped(frame: Frame, call: ir.Call) -> bool:
    """Tell whether a call's result is not used: then it is there for what it does."""
    return isinstance(frame.statement, ir.Evaluate) and frame.statement.value is call


BUILTIN: Mapping[str, Callable[..., Value]] = {
    **dict.fromkeys(CONTAINERS, Library._new_container),
    **dict.fromkeys(QUEUES, Library._new_queue),
    "dict": Library._new_mapping,
    "OrderedDict": Library._new_mapping,
    "defaultdict": Library._new_mapping,
    "Counter": Library._new_mapping,
    "dict.fromkeys": Library.from_keys,
    "namedtuple": Library._named_tuple,
    "dataclasses.field": Library._field,
    "dataclasses.replace": Library._replaced,
    "copy.replace": Library._replaced,
    **dict.fromkeys(("dataclasses.asdict", "attr.asdict", "attrs.asdict"), Library._as_mapping),
    **dict.fromkeys(("dataclasses.astuple", "attr.astuple", "attrs.astuple"), Library._as_sequence),
    **dict.fromkeys(("attr.evolve", "attrs.evolve"), Library._replaced),
    "object.__new__": Library._blank_object,
    **dict.fromkeys(("weakref.ref", "weakref.WeakMethod"), Library._weak),
    **dict.fromkeys(("weakref.proxy", "vars", "typing.cast"), Library._same),
    "type": Library.type_of,
    **dict.fromkeys(("isinstance", "issubclass", "hasattr", "callable"), Library.of_type),
    "len": Library._counted,
    **dict.fromkeys(("bool", "any", "all"), Library.asked),
    "str": Library.as_text,
    **dict.fromkeys(catalog.SAME_TEXT, Library.same_text),
    **dict.fromkeys(catalog.PATH_JOINS, Library.joined_path),
    "enumerate": Library._zipped,
    "zip": Library._zipped,
    "map": Library._mapped,
    "filter": Library._mapped,
    "min": Library._chosen,
    "max": Library._chosen,
    "next": Library._chosen,
    "asyncio.gather": Library._gathered,
    **dict.fromkeys(catalog.ADDS_STATE, Library.add_state),
    **dict.fromkeys(catalog.STATE_BY_CALLBACKS, Library.state_by_callbacks),
    **dict.fromkeys(catalog.AWAITING, Library._awaited),
    "getattr": Library.get_attribute,
    **dict.fromkeys(("operator.attrgetter", "operator.itemgetter"), Library.getter),
    **dict.fromkeys(("operator.attrgetter.<made>", "operator.itemgetter.<made>"), Library.get_named),
    "setattr": Library.set_attribute,
    "super": Library.parent,
}
