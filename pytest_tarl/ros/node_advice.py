"""Advice on a node's error: what is missing, and what to do."""

from __future__ import annotations

import ast
import linecache
import re
import sys
from collections.abc import Collection, Iterator, Sequence
from types import FrameType, TracebackType
from typing import Final, TypeGuard

from pytest_tarl.errors import text_of
from pytest_tarl.ros import blame
from pytest_tarl.ros.absent_names import caught_import, removed_name
from pytest_tarl.ros.launch_sources import Given, arguments_from, parameter_from
from pytest_tarl.ros.missing_modules import PYTHON_2, interface_advice, module_advice

_PYTHON_2_SYNTAX = re.compile(
    r"Missing parentheses in call to '(print|exec)|multiple exception types must be parenthesized|"
    r"leading zeros in decimal integer literals|inconsistent use of tabs"
)
_PYTHON_2_NAMES = re.compile(
    r"name '(raw_input|unicode|xrange|basestring|long|reduce|file|unichr|execfile|cmp)' is not defined|"
    r"has no attribute '(iteritems|itervalues|iterkeys|has_key|maxint)'|cannot import name 'maxint'"
)

_INTEGER_NEEDED = re.compile(
    r"'float' object cannot be interpreted as an integer|can't multiply sequence by non-int of type 'float'|"
    r"^slice indices must be integers|indices must be integers or slices, not float|only integers, slices"
)
_LACKING: Final = re.compile(r"^module '([\w.]+)' has no attribute ")
_NO_SERVICE: Final = re.compile(r"^service \[(.+)\] unavailable")
_NO_FRAME: Final = re.compile(r'"([^"]+)" passed to lookupTransform argument does not exist')
_ABSENT_PARTNERS: Final = ("ServiceException", "TransformException", "LookupException")
_NONE: Final = re.compile(r"\bNone(Type)?\b")
_WORD: Final = 4  # a word must have this many letters to count as similar to a parameter's name
_SHOWN: Final = 3  # maximum number of parameters in one sentence
_ARGUMENTS: Final = re.compile(r"\bargv\b|\bmyargv\b|\bparse_(known_)?args\b")


def advice(error: BaseException, given: Given, unset: Sequence[str] = ()) -> str:
    """Return a sentence of advice on a node's error; empty if the error's own text is enough.

    `given` is what launch files pass to the node; `unset` has the parameters without a value that it asked for.
    """
    text = text_of(error)
    if isinstance(error, SyntaxError):
        return PYTHON_2 if _PYTHON_2_SYNTAX.search(text) or isinstance(error, TabError) else ""
    if isinstance(error, NameError | AttributeError | ImportError) and _PYTHON_2_NAMES.search(text):
        return PYTHON_2
    if isinstance(error, ImportError):
        return _of_import(error)
    lacking = _LACKING.search(text) if isinstance(error, AttributeError) else None
    if lacking is not None:
        return removed_name(lacking[1], text)
    if isinstance(error, NameError):
        own = _of_program(error)
        return caught_import(error, own[-1].tb_frame.f_code.co_filename) if own else ""
    if isinstance(error, KeyError):
        return _of_lookup(error, given)
    if type(error).__name__ == "ParameterUninitializedException" and error.args:
        return _of_parameter(text_of(error.args[0]).rpartition(": ")[2], given)
    if isinstance(error, TypeError | IndexError) and _INTEGER_NEEDED.search(text) and _divides(error):
        return "In Python 3, / of two integers gives a float: write // where Python 2 rounded down."
    if isinstance(error, SystemExit | IndexError):
        exits = isinstance(error, SystemExit)
        return _of_arguments(error, given) or (_of_unset(unset, "") if exits and unset else "")
    return _of_values(error, text, unset)


def _of_values(error: BaseException, text: str, unset: Sequence[str]) -> str:
    """Return advice for a node that lacks values, another node, or a library's argument; otherwise ""."""
    if unset and isinstance(error, TypeError | AttributeError | ValueError) and _NONE.search(text):
        return _of_unset(unset, _line_of(error))
    if type(error).__name__ in _ABSENT_PARTNERS:
        return _of_partner(text)
    if isinstance(error, TypeError) and "required positional argument: 'Loader'" in text:
        return (
            "PyYAML 6 has no default for it: call yaml.safe_load in the node, or run pip install 'PyYAML<6' in the "
            "environment of the tests."
        )
    return ""


def _of_import(error: ImportError) -> str:
    """Return advice for a failed import."""
    if isinstance(error, ModuleNotFoundError):
        return module_advice(error, _line_of(error))
    if error.name is None:
        return ""
    # a module without a path is a folder without Python files, or built into Python
    return interface_advice(error.name) or removed_name(error.name, text_of(error))


def _of_partner(text: str) -> str:
    """Return advice for a service or frame that no node and no test provides."""
    service, frame = _NO_SERVICE.search(text), _NO_FRAME.search(text)
    if service is not None:
        return f'No node offers it: offer it in the test with tarl.bus.serve("{service[1]}", type, handler).'
    if frame is not None:
        return (
            f"No node sends a transform with the frame {frame[1]}: publish one on /tf_static or /tf in the test "
            "(tf2_msgs/TFMessage)."
        )
    return ""


def _of_unset(unset: Sequence[str], line: str) -> str:
    """Return advice for a node that fails with None after reading parameters without a value.

    Parameters whose names resemble a word in the failing line come first.
    """
    words = [one for one in re.findall(r"\w+", line) if len(one) >= _WORD]

    def differs(name: str) -> bool:
        last = name.rpartition("/")[2]
        return not any(one in last or (len(last) >= _WORD and last in one) for one in words)

    names = sorted(dict.fromkeys(one.removeprefix("~") for one in unset), key=differs)
    shown = ", ".join(names[:_SHOWN]) + (f" and {len(names) - _SHOWN} more" if len(names) > _SHOWN else "")
    return (
        f'Parameters that it asked for have no value: {shown}. If it needs one, pass parameters={{"{names[0]}": …}} '
        "to tarl.start."
    )


def _of_lookup(error: KeyError, given: Given) -> str:
    """Return advice for a missing parameter or environment variable."""
    last = _innermost(error)
    if last is None or not error.args:
        return ""
    name = text_of(error.args[0])
    if last.f_globals.get("__name__") == "os":
        return (
            f'The environment variable {name} is not set: call monkeypatch.setenv("{name}", …) in the test.'
        )
    if last.f_code.co_name != "get_param":
        return ""
    return _of_parameter(name.removeprefix("~"), given)


def _of_parameter(plain: str, given: Given) -> str:
    """Return advice for a parameter without a value."""
    sources = parameter_from(given.sources, plain)
    if sources:
        return f'{sources}, or pass parameters={{"{plain}": …}} to tarl.start.'
    why = (
        "The launch file gives the parameter no value that is known before the launch"
        if plain in given.valueless
        else "Neither the test nor a launch file that starts the node sets this parameter"
    )
    return f'{why}: pass parameters={{"{plain}": …}} to tarl.start.'


def _of_arguments(error: BaseException, given: Given) -> str:
    """Return advice on missing command line arguments, with the message of the node's argument parser."""
    sources = arguments_from(given.sources)
    hint = f"{sources}, or pass argv=[…] to tarl.start." if sources else "pass argv=[…] to tarl.start."
    for frame in _frames(error):
        module = frame.f_globals.get("__name__")
        if module in ("argparse", "optparse") and frame.f_code.co_name == "error":
            said = frame.f_locals.get("message") or frame.f_locals.get("msg")
            return f"Its command line is incomplete ({said}): {hint}"
    looks = (
        any(map(_checks_arguments, _of_program(error)))
        if isinstance(error, SystemExit)
        else _indexes_arguments(_of_program(error)[-1:])
    )
    return f"The node reads its command line: {hint}" if looks else ""


def _line_of(error: BaseException) -> str:
    """Return the line of the node's own code that raised the error."""
    own = _of_program(error)
    return linecache.getline(own[-1].tb_frame.f_code.co_filename, own[-1].tb_lineno) if own else ""


def _divides(error: BaseException) -> bool:
    """Return whether the node's file that raised the error divides by `/`."""
    own = _of_program(error)
    text = "".join(linecache.getlines(own[-1].tb_frame.f_code.co_filename)) if own else ""
    try:
        return any(isinstance(node, ast.Div) for node in ast.walk(ast.parse(text)))
    except (SyntaxError, ValueError):
        return False


def _of_program(error: BaseException) -> list[TracebackType]:
    """Return the entries of an error's traceback in the node's own files."""
    entries = [*_traceback(error)]
    began = next(
        (place for place, one in enumerate(entries) if one.tb_frame.f_globals.get("__name__") == "__main__"),
        0,
    )
    return [one for one in entries[began:] if not blame.is_library(one.tb_frame.f_code.co_filename)]


def _checks_arguments(entry: TracebackType) -> bool:
    """Return whether the failing statement or its condition reads the arguments."""
    texts = _statement_and_conditions(entry.tb_frame.f_code.co_filename, entry.tb_lineno)
    return any(_ARGUMENTS.search(text) for text in texts)


def _indexes_arguments(innermost: Sequence[TracebackType]) -> bool:
    """Return whether the failing line uses `sys.argv`."""
    for entry in innermost:
        line = linecache.getline(entry.tb_frame.f_code.co_filename, entry.tb_lineno)
        held = [name for name, value in entry.tb_frame.f_locals.items() if _is_argv(value)]
        if any(re.search(rf"\b{re.escape(name)}\b", line) for name in ("argv", *held)):
            return True
    return False


def _is_argv(value: object) -> bool:
    """Return whether a node's variable equals `sys.argv`, without calling code of its class.

    Arrays compare element by element, and other objects may raise.
    """
    return type(value) is list and all(type(one) is str for one in value) and value == sys.argv


def _statement_and_conditions(file: str, line: int) -> Iterator[str]:
    """Yield a line of a file, and the conditions of the `if` statements around it.

    Each condition is followed by the values that the file assigns to names in the condition.
    """
    yield linecache.getline(file, line)
    try:
        tree = ast.parse("".join(linecache.getlines(file)))
    except (SyntaxError, ValueError):
        return
    for node in ast.walk(tree):
        if isinstance(node, ast.If) and node.lineno <= line <= (node.end_lineno or node.lineno):
            yield ast.unparse(node.test)
            used = {one.id for one in ast.walk(node.test) if isinstance(one, ast.Name)}
            yield from (ast.unparse(one.value) for one in ast.walk(tree) if _assigns(one, used))


def _assigns(node: ast.AST, names: Collection[str]) -> TypeGuard[ast.Assign]:
    """Return whether a statement assigns to one of these names."""
    return isinstance(node, ast.Assign) and any(
        isinstance(one, ast.Name) and one.id in names for target in node.targets for one in ast.walk(target)
    )


def _innermost(error: BaseException) -> FrameType | None:
    return next(reversed([*_frames(error)]), None)


def _frames(error: BaseException) -> Iterator[FrameType]:
    """Yield the frames of an error's traceback, outermost first."""
    yield from (entry.tb_frame for entry in _traceback(error))


def _traceback(error: BaseException) -> Iterator[TracebackType]:
    """Yield the entries of an error's traceback, outermost first."""
    entry = error.__traceback__
    while entry is not None:
        yield entry
        entry = entry.tb_next
