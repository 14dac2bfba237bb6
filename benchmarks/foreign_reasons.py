"""Classify failures of node scripts: the missing feature, or the reason to count the script separately."""

from __future__ import annotations

import re
from functools import cache
from pathlib import Path

from foreign_scripts import DISTRIBUTED

KINDS = {  # pattern in a failed test's message → name of the missing feature
    r"No module named '([\w.]+)'": "module {0}",
    r"cannot import name '(\w+)' from '([\w.]+)'": "name {1}.{0}",
    r"([\w.]+) is not in the in-process ROS": "ROS API {0}",
    r"Message type ([\w/]+) is unknown": "message {0}",
    r"KeyError: '?([~/\w]+)'? \(.*get_param": "parameter {0}",
    r"exited with status 2|reads its command line|command line is incomplete": "command line arguments",
    r"(EOFError|termios.error|reading from stdin)": "keyboard",
    r"KeyError: '(?:TURTLEBOT3_MODEL|LDS_MODEL|[A-Z_]{5,})'": "environment variable",
    r"closed here: ([\w.]+)": "operating system ({0})",
    r"never (waits)": "time: it never waits",
    r"package '(\w+)' not found": "package {0}",
    r"No such file or directory: '([^']+)'": "file {0}",
    r"raised (\w+: .{0,60})": "own {0}",
}
PYTHON_2 = re.compile(
    r"raised (SyntaxError: |TabError|IndentationError|ModuleNotFoundError: No module named '(thread|Queue|cPickle|"
    r"ConfigParser|urllib2|StringIO|Tkinter|commands|HTMLParser|httplib|sets|cv)'|NameError: name '(raw_input|unicode|"
    r"xrange|basestring|long|reduce|file|unichr|execfile)'|AttributeError: .* has no attribute '(iteritems|has_key|"
    r"itervalues|maxint|next|decode)'|ImportError: cannot import name 'maxint')"
)


def why(fails: str) -> str:
    """Return the missing feature that a failure's message names."""
    for pattern, name in KINDS.items():
        found = re.search(pattern, fails)
        if found is not None:
            return name.format(*found.groups())
    return fails.strip().splitlines()[-1][:100] if fails.strip() else ""


def set_apart(fails: str, repository: Path) -> str:
    """Return why to count a script separately: it needs Python 2, a display, or an unavailable package."""
    old = PYTHON_2.search(fails)
    if old is not None:
        return f"Python 2 only ({old[1]})"
    if "highgui" in fails:
        return "needs a display: a window of OpenCV"
    found = re.search(r"No module named '(\w+)", fails)
    name = found[1] if found is not None else ""
    if not name or name in DISTRIBUTED or name in _in_checkout(repository):
        return ""
    return f"needs a package from elsewhere: {name}"


@cache
def _in_checkout(repository: Path) -> frozenset[str]:
    """Return the names of all files, folders and packages that code in a checkout could import."""
    named = {path.stem for path in repository.rglob("*") if path.suffix in ("", ".py")}
    manifests = (path.read_text("utf-8", errors="replace") for path in repository.rglob("package.xml"))
    return frozenset(named | {name for text in manifests for name in re.findall(r"<name>\s*([\w-]+)", text)})
