"""Advice on the error of a node: a sentence that says what its environment lacks and what to do."""

from __future__ import annotations

import linecache
import re
from collections.abc import Iterator
from types import FrameType

from pytest_tarl.ros import blame
from pytest_tarl.ros.launched import Given
from pytest_tarl.ros.missing_modules import PYTHON_2, module_advice

_PYTHON_2_SYNTAX = re.compile(
    r"Missing parentheses in call to '(print|exec)|multiple exception types must be parenthesized|"
    r"leading zeros in decimal integer literals|inconsistent use of tabs"
)
_PYTHON_2_NAMES = re.compile(
    r"name '(raw_input|unicode|xrange|basestring|long|reduce|file|unichr|execfile|cmp)' is not defined|"
    r"has no attribute '(iteritems|itervalues|iterkeys|has_key|maxint)'|cannot import name 'maxint'"
)


def advice(error: BaseException, given: Given) -> str:
    """Return one sentence of advice about a node's error; empty if the error's own text is enough.

    `given` holds the parameters that launch files give the node.
    """
    if isinstance(error, SyntaxError):
        return PYTHON_2 if _PYTHON_2_SYNTAX.search(str(error)) or isinstance(error, TabError) else ""
    if isinstance(error, ModuleNotFoundError):
        return module_advice(error)
    if isinstance(error, ImportError) and (error.name or "").partition(".")[0] in ("rclpy", "rospy"):
        return f"The in-process ROS lacks this name of {error.name}: put a replacement into the module in the test."
    if isinstance(error, NameError | AttributeError | ImportError):
        return PYTHON_2 if _PYTHON_2_NAMES.search(str(error)) else ""
    if isinstance(error, KeyError):
        return _of_lookup(error, given)
    if isinstance(error, SystemExit | IndexError):
        return _of_arguments(error)
    if isinstance(error, TypeError) and "required positional argument: 'Loader'" in str(error):
        return (
            "PyYAML 6 has no default for it: call yaml.safe_load in the node, or run pip install 'PyYAML<6' in the "
            "environment of the tests."
        )
    return ""


def _of_lookup(error: KeyError, given: Given) -> str:
    """Return advice for a parameter or an environment variable that is not set."""
    last = _innermost(error)
    if last is None or not error.args:
        return ""
    name = str(error.args[0])
    if last.f_globals.get("__name__") == "os":
        return (
            f'The environment variable {name} is not set: call monkeypatch.setenv("{name}", …) in the test.'
        )
    if last.f_code.co_name != "get_param":
        return ""
    plain = name.removeprefix("~")
    why = (
        "The launch file gives the parameter no value that is known before the launch"
        if plain in given.valueless
        else "Neither the test nor a launch file that starts the node sets this parameter"
    )
    return f'{why}: pass parameters={{"{plain}": …}} to tarl.start.'


def _of_arguments(error: BaseException) -> str:
    """Return advice about missing command line arguments, including the message of the node's argument parser."""
    hint = "pass argv=[…] to tarl.start."
    for frame in _frames(error):
        module = frame.f_globals.get("__name__")
        if module in ("argparse", "optparse") and frame.f_code.co_name == "error":
            said = frame.f_locals.get("message") or frame.f_locals.get("msg")
            return f"Its command line is incomplete ({said}): {hint}"
    place = blame.of_traceback(error.__traceback__)
    if place is not None and "argv" in linecache.getline(place[0], place[1]):
        return f"The node reads its command line: {hint}"
    return ""


def _innermost(error: BaseException) -> FrameType | None:
    return next(reversed([*_frames(error)]), None)


def _frames(error: BaseException) -> Iterator[FrameType]:
    """Yield the frames of an error's traceback, outermost first."""
    traceback = error.__traceback__
    while traceback is not None:
        yield traceback.tb_frame
        traceback = traceback.tb_next
