"""Forms of one controller: its gain of 2 is written in the node, a helper module or a file, in many notations.

A form is what the node has in place of the parts below; `# here` marks the line in which its gain is defined.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Final

NODE: Final = """\
import argparse
import functools
import json
import math
import os
from collections import namedtuple
from dataclasses import dataclass, field
from enum import Enum
from types import SimpleNamespace
from typing import NamedTuple

import helper
import numpy as np
import rospy
import yaml
from helper import GAIN as IMPORTED
from helper import Base, Config, gain as given
from std_msgs.msg import Float64

{before}


class Keeper{bases}:
    {attribute}

    def __init__(self{argument}):
        {first}
        self.out = rospy.Publisher("/out", Float64, queue_size=1)
        rospy.Subscriber("/in", Float64, self.on_value)

    {method}

    def on_value(self, msg):
        value = {use} * msg.data
        self.out.publish(value)


if __name__ == "__main__":
    rospy.init_node("keeper")
    Keeper({call})
"""
HELPER: Final = """\
from dataclasses import dataclass

GAIN = 2.0{constant}
SETTINGS = {{"gain": 2.0}}{table}


class Limits:
    gain = 2.0{limits}


class Base:
    rise = 2.0{base}

    def __init__(self):
        self.based = 2.0{init}


def gain():
    return 2.0{function}


@dataclass
class Config:
    gain: float = 2.0{config}
"""
HELPERS: Final = ("constant", "table", "limits", "base", "init", "function", "config")
HERE: Final = "  # here"
DATA: Final = {"c.yaml": "pid:\n  gain: 2.0  # here\n", "c.json": '{"pid": {"gain": 2.0}}\n'}
RECORD: Final = "@dataclass\nclass Gains:\n    gain: float = 2.0  # here\n"
READ: Final = "def read(name, default):\n    return rospy.get_param('~' + name, default)\n"
LOADED: Final = 'with open(os.path.join(FOLDER, "c.yaml")) as file:\n    C = yaml.safe_load(file)'


def _method(text: str) -> str:
    return text.replace("\n", "\n    ")


COMMAND_LINE: Final = (
    "parser = argparse.ArgumentParser()\nparser.add_argument({option})  # here\nA = parser.parse_args([])"
)
FORMS: Final[Mapping[str, Mapping[str, str]]] = {
    "literal": {"use": "2.0"},
    "module constant": {"before": "GAIN = 2.0  # here", "use": "GAIN"},
    "annotated": {"before": "GAIN: float = 2.0  # here", "use": "GAIN"},
    "another name": {"before": "BASE = 2.0  # here\nGAIN = BASE", "use": "GAIN"},
    "unpacked": {"before": "GAIN, OTHER = 2.0, 1.0  # here", "use": "GAIN"},
    "set by a function": {
        "before": "GAIN = None\n\n\ndef setup():\n    global GAIN\n    GAIN = 2.0  # here\n",
        "first": "setup()",
        "use": "GAIN",
    },
    "negative": {"before": "GAIN = -2.0  # here", "use": "-GAIN"},
    "conversion": {"before": "GAIN = float(2.0)  # here", "use": "GAIN"},
    "angle": {"before": "GAIN = math.radians(114.59155902616465)  # here", "use": "GAIN"},
    "share of pi": {"before": "GAIN = 0.6366197723675814 * math.pi  # here", "use": "GAIN"},
    "class attribute": {"attribute": "gain = 2.0  # here", "use": "self.gain"},
    "class attribute of the class": {"attribute": "gain = 2.0  # here", "use": "Keeper.gain"},
    "base class": {"before": "class B:\n    gain = 2.0  # here\n", "bases": "(B)", "use": "self.gain"},
    "imported base class": {"bases": "(Base)", "use": "self.rise", "base": HERE},
    "super": {"bases": "(Base)", "first": "super().__init__()", "use": "self.based", "init": HERE},
    "base by name": {"bases": "(Base)", "first": "Base.__init__(self)", "use": "self.based", "init": HERE},
    "attribute": {"first": "self.gain = 2.0  # here", "use": "self.gain"},
    "default": {"argument": ", gain=2.0", "first": "self.gain = gain", "use": "self.gain", "marked": "def __init__("},
    "argument": {
        "argument": ", gain",
        "first": "self.gain = gain",
        "use": "self.gain",
        "call": "2.0",
        "marked": "    Keeper(2",
    },
    "keyword": {
        "argument": ", gain",
        "first": "self.gain = gain",
        "use": "self.gain",
        "call": "gain=2.0",
        "marked": "    Keeper(gain",
    },
    "rest of the keywords": {
        "argument": ", **more",
        "first": 'self.gain = more["gain"]',
        "use": "self.gain",
        "call": "gain=2.0",
        "marked": "    Keeper(gain",
    },
    "helper's constant": {"use": "IMPORTED", "constant": HERE},
    "helper's constant by module": {"use": "helper.GAIN", "constant": HERE},
    "helper's class": {"use": "helper.Limits.gain", "limits": HERE},
    "helper's table": {"use": 'helper.SETTINGS["gain"]', "table": HERE},
    "helper's function": {"use": "given()", "function": HERE},
    "helper's function by module": {"use": "helper.gain()", "function": HERE},
    "helper's dataclass": {"first": "self.c = Config()", "use": "self.c.gain", "config": HERE},
    "dataclass": {"before": RECORD, "first": "self.c = Gains()", "use": "self.c.gain"},
    "frozen dataclass": {
        "before": RECORD.replace("dataclass", "dataclass(frozen=True)"),
        "first": "self.c = Gains()",
        "use": "self.c.gain",
    },
    "field": {
        "before": RECORD.replace("= 2.0", "= field(default=2.0)"),
        "first": "self.c = Gains()",
        "use": "self.c.gain",
    },
    "dataclass in a dataclass": {
        "before": f"{RECORD}\n\n@dataclass\nclass All:\n    gains: Gains = field(default_factory=Gains)\n",
        "first": "self.c = All()",
        "use": "self.c.gains.gain",
    },
    "dataclass at module level": {"before": f"{RECORD}\n\nC = Gains()", "use": "C.gain"},
    "dataclass passed": {
        "before": RECORD,
        "argument": ", c",
        "first": "self.c = c",
        "use": "self.c.gain",
        "call": "Gains()",
    },
    "dataclass filled": {
        "before": "@dataclass\nclass Gains:\n    gain: float\n    more: float\n",
        "first": "self.c = Gains(gain=2.0, more=1.0)  # here",
        "use": "self.c.gain",
    },
    "dataclass in a product": {
        "before": f"{RECORD}    more: float = 1.0  # here\n",
        "first": "self.c = Gains()",
        "use": "self.c.more * self.c.gain",
    },
    "property of a dataclass": {
        "before": f"{RECORD}\n    @property\n    def both(self):\n        return self.gain\n",
        "first": "self.c = Gains()",
        "use": "self.c.both",
    },
    "named tuple": {
        "before": "Gains = namedtuple('Gains', 'gain more')",
        "first": "self.c = Gains(2.0, 1.0)  # here",
        "use": "self.c.gain",
    },
    "NamedTuple": {
        "before": "class Gains(NamedTuple):\n    gain: float = 2.0  # here\n",
        "first": "self.c = Gains()",
        "use": "self.c.gain",
    },
    "namespace": {"before": "C = SimpleNamespace(gain=2.0)  # here", "use": "C.gain"},
    "enumeration": {"before": "class C(Enum):\n    GAIN = 2.0  # here\n", "use": "C.GAIN.value"},
    "class of constants": {"before": "class C:\n    GAIN = 2.0  # here\n", "use": "C.GAIN"},
    "dictionary": {"before": 'C = {"gain": 2.0}  # here', "use": 'C["gain"]'},
    "nested dictionary": {"before": 'C = {"pid": {"gain": 2.0}}  # here', "use": 'C["pid"]["gain"]'},
    "dict()": {"before": "C = dict(gain=2.0, more=1.0)  # here", "use": 'C["gain"]'},
    "get": {"before": 'C = {"gain": 2.0}  # here', "use": 'C.get("gain")'},
    "get with a default": {"before": 'C = {"gain": 2.0}  # here', "use": 'C.get("gain", 1.0)'},
    "merged dictionary": {"before": 'D = {"gain": 2.0}  # here\nC = {**D}', "use": 'C["gain"]'},
    "dictionary kept": {"first": 'self.c = {"gain": 2.0}  # here', "use": 'self.c["gain"]'},
    "list": {"before": "C = [2.0, 1.0]  # here", "use": "C[0]"},
    "array": {"before": "C = np.array([2.0, 1.0])  # here", "use": "C[0]"},
    "array that gets longer": {"before": "C = np.array([1.0])\nC = np.array([2.0, 1.0])  # here", "use": "C[-2]"},
    "getattr": {"first": "self.gain = 2.0  # here", "use": 'getattr(self, "gain")'},
    "property": {
        "first": "self._gain = 2.0  # here",
        "method": _method("@property\ndef gain(self):\n    return self._gain\n"),
        "use": "self.gain",
    },
    "property of a literal": {
        "method": _method("@property\ndef gain(self):\n    return 2.0  # here\n"),
        "use": "self.gain",
    },
    "cached property": {
        "method": _method("@functools.cached_property\ndef gain(self):\n    return 2.0  # here\n"),
        "use": "self.gain",
    },
    "getter": {
        "first": "self._gain = 2.0  # here",
        "method": _method("def gain(self):\n    return self._gain\n"),
        "use": "self.gain()",
    },
    "getter of a literal": {"method": _method("def gain(self):\n    return 2.0  # here\n"), "use": "self.gain()"},
    "static getter": {"method": _method("@staticmethod\ndef gain():\n    return 2.0  # here\n"), "use": "self.gain()"},
    "getter's default": {
        "method": _method("def gain(self, gain=2.0):  # here\n    return gain\n"),
        "use": "self.gain()",
    },
    "setter": {
        "first": "self.set(2.0)  # here",
        "method": _method("def set(self, gain):\n    self.g = gain\n"),
        "use": "self.g",
    },
    "lambda": {"first": "self.gain = lambda: 2.0  # here", "use": "self.gain()"},
    "choice": {"before": 'GAIN = 2.0 if os.sep == "/" else 1.0', "use": "GAIN"},
    "parameter": {"first": 'self.gain = rospy.get_param("~gain", 2.0)  # here', "use": "self.gain"},
    "converted parameter": {"first": 'self.gain = float(rospy.get_param("~gain", 2.0))  # here', "use": "self.gain"},
    "parameter by a method": {
        "first": 'self.gain = self.read("gain", 2.0)  # here',
        "method": _method(READ.replace("(name", "(self, name")),
        "use": "self.gain",
    },
    "parameter by a function": {"before": READ, "first": 'self.gain = read("gain", 2.0)  # here', "use": "self.gain"},
    "parameter at its use": {"before": READ, "use": 'read("gain", 2.0)'},
    "parameters in a loop": {
        "before": READ,
        "first": (
            'for name, usual in (("gain", 2.0), ("more", 1.0)):  # here\n'
            '            setattr(self, name, read(name, usual))'
        ),
        "use": "self.gain",
    },
    "table of parameters": {
        "first": 'self.c = rospy.get_param("~pid", {"gain": 2.0})  # here',
        "use": 'self.c["gain"]',
    },
    "yaml": {"before": LOADED, "use": 'C["pid"]["gain"]', "data": "c.yaml"},
    "yaml under a name": {"before": f'{LOADED}\nGAIN = C["pid"]["gain"]', "use": "GAIN", "data": "c.yaml"},
    "yaml converted": {"before": f'{LOADED}\nGAIN = float(C["pid"]["gain"])', "use": "GAIN", "data": "c.yaml"},
    "yaml with a default": {"before": LOADED, "use": 'C["pid"].get("gain", 1.0)', "data": "c.yaml"},
    "yaml in __init__": {
        "first": (
            'with open(os.path.join(FOLDER, "c.yaml")) as file:\n'
            '            self.gain = yaml.safe_load(file)["pid"]["gain"]'
        ),
        "use": "self.gain",
        "data": "c.yaml",
    },
    "yaml by a function": {
        "before": (
            'def load():\n    with open(os.path.join(FOLDER, "c.yaml")) as file:\n'
            '        return yaml.safe_load(file)\n\n\nC = load()["pid"]'
        ),
        "use": 'C["gain"]',
        "data": "c.yaml",
    },
    "yaml in a dataclass": {
        "before": f"{LOADED}\n\n\n@dataclass\nclass Gains:\n    gain: float = 1.0\n",
        "first": 'self.c = Gains(gain=C["pid"]["gain"])',
        "use": "self.c.gain",
        "data": "c.yaml",
    },
    "json": {
        "before": LOADED.replace("c.yaml", "c.json").replace("yaml.safe_load", "json.load"),
        "use": 'C["pid"]["gain"]',
        "data": "c.json",
    },
    "environment": {"before": f'GAIN = float(os.environ.get("KEEPER_GAIN", "2.0")){HERE}', "use": "GAIN"},
    "command line": {
        "before": COMMAND_LINE.format(option='"--gain", type=float, default=2.0'),
        "use": "A.gain",
    },
    "command line by another name": {
        "before": COMMAND_LINE.format(option='"-g", type=float, default=2.0, dest="gain"'),
        "use": "A.gain",
    },
}  # fmt: skip


def node(name: str, folder: str) -> tuple[str, str]:
    """Return the texts of a form's node and of its helper."""
    form = FORMS[name]
    usual = {
        "before": "",
        "bases": "",
        "attribute": "pass",
        "argument": "",
        "first": "pass",
        "method": "",
        "call": "",
    }
    text = NODE.format(**(usual | {key: value for key, value in form.items() if key not in HELPERS}))
    text = text.replace("FOLDER", repr(folder))
    if "marked" in form:
        text = "\n".join(line + HERE * (form["marked"] in line) for line in text.split("\n"))
    return text, HELPER.format(**{key: form.get(key, "") for key in HELPERS})
