"""Texts of the environment and the command line, with their defaults.

A default is the text that is used if the robot gives no other text, so topics with this name are known.
"""

from __future__ import annotations

from tarl_lint.interpret.interpreter import Interpreter
from tarl_lint.interpret.invocation import Invocation
from tarl_lint.memory import recency
from tarl_lint.memory.heap import ANY, item_field
from tarl_lint.memory.symbolic_names import with_default
from tarl_lint.memory.values import BOTTOM, GIVEN, Value, pointer

VARIABLES = ("os.environ.get", "os.getenv", "os.environ.setdefault", "os.environ.pop")
# lists and mappings of texts that are known only on the robot
TEXTS = frozenset(["os.environ", "sys.argv"])
OPTION = "<option>"  # start of the names of a parser's fields that hold defaults
ADDING = "add_argument"


def variable(ctx: Interpreter, it: Invocation) -> Value:
    """Return the value of a variable of the environment: any text, or the default."""
    made = ctx.ops.generic(ctx, it.name, it.arguments, it.frame, it.call)
    plain, named = it.arguments
    default = plain[1] if len(plain) > 1 else named.get("default", BOTTOM)
    consts = frozenset([GIVEN]) if default is BOTTOM else with_default(default)
    return made if consts is None else Value(ctx.use(made), consts=consts)


def text_of(base: Value) -> Value | None:
    """Return an element of the environment or the command line; None for other objects."""
    names = {o.name for o in base.pts if o.kind == "ext"}
    if len(names) != 1 or len(base.pts) != 1 or not names <= TEXTS:
        return None
    return Value(base.deps, consts=frozenset([GIVEN]))


def option(ctx: Interpreter, it: Invocation) -> None:
    """Record the default of an option that `add_argument` declares, if it is a string."""
    plain, named = it.arguments
    consts = with_default(named.get("default", BOTTOM))
    flags = [text for value in plain for text in value.texts()]
    if consts is None or len(it.base.pts) != 1 or not flags:
        return
    (parser,) = it.base.pts
    long = next((flag for flag in flags if flag.startswith("--")), flags[0])
    names = named["dest"].texts() if "dest" in named else (long.lstrip("-").replace("-", "_"),)
    for name in names:
        ctx.store.put((parser, f"{OPTION}{name}"), Value(consts=consts))


def options(ctx: Interpreter, it: Invocation, made: Value) -> Value:
    """Store the defaults of the declared options in the result of `parse_args` or `parse_known_args`."""
    if len(it.base.pts) != 1:
        return made
    (parser,) = it.base.pts
    ctx.store.look(parser)
    declared = [name for name in list(parser.fields) if name.startswith(OPTION)]
    if not declared:
        return made
    space = recency.allocate(ctx, "lib", it.frame, ("options", it.call.slot))
    if deps := ctx.use(made):
        ctx.store.put((space, ANY), Value(deps))
    for name in declared:
        value = ctx.store.get((parser, name))
        if value is not None:
            ctx.store.put((space, name.removeprefix(OPTION)), value)
    if it.name == "parse_args":
        return pointer(space)
    pair = recency.allocate(ctx, "sequence", it.frame, ("parsed", it.call.slot))
    for number, part in enumerate((pointer(space), made)):
        ctx.store.put((pair, item_field(number)), part)
    return pointer(pair)
