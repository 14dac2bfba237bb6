"""Advice for an import of a module that is neither in this interpreter nor in the workspace."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Final

from pytest_tarl.ros.messages.node_workspaces import packages, workspaces
from pytest_tarl.ros.messages.package_modules import PARTS
from pytest_tarl.ros.uninstalled import candidates

PYTHON_2: Final = "This is Python 2, which no supported ROS uses: port the node to Python 3."
_OF_PYTHON_2: Final = frozenset(
    ["ConfigParser", "HTMLParser", "Queue", "StringIO", "Tkinter", "cPickle", "commands", "cookielib", "cv", "httplib",
     "sets", "thread", "urllib2", "urlparse"]
)  # fmt: skip
_PIP_NAMES: Final[Mapping[str, str]] = {  # module → pip package, where the names differ
    "Crypto": "pycryptodome",
    "OpenGL": "PyOpenGL",
    "PIL": "pillow",
    "bluetooth": "PyBluez",
    "cv2": "opencv-python-headless",
    "dynamixel_sdk": "dynamixel-sdk",
    "git": "GitPython",
    "serial": "pyserial",
    "skimage": "scikit-image",
    "sklearn": "scikit-learn",
    "speech_recognition": "SpeechRecognition",
    "usb": "pyusb",
    "websocket": "websocket-client",
    "yaml": "PyYAML",
    "zmq": "pyzmq",
}
_DEVICES: Final = frozenset(
    ["Adafruit_PCA9685", "Jetson", "RPi", "alsaaudio", "board", "busio", "picamera", "pigpio", "pyaudio",
     "pyrealsense2", "rpi_ws281x", "smbus", "smbus2", "spidev"]
)  # fmt: skip
_COMPILED: Final = frozenset(["ompl", "openravepy", "pcl", "trac_ik_python"])


def module_advice(error: ModuleNotFoundError, line: str = "") -> str:
    """Return a sentence on how to make a failed import work; `line` is the importing line of code."""
    root, _, inner = (error.name or "").partition(".")
    if inner in PARTS:
        return interface_advice(
            f"{root}.{inner}"
        )  # the package has Python modules, but no definitions were found
    if inner or not root:
        return ""  # the package exists, so the name is misspelled
    interface = re.search(rf"\b{re.escape(root)}\.({'|'.join(PARTS)})\b", line)
    return _in_workspace(root) or (_definitions(root, interface[1]) if interface else _elsewhere(root))


def interface_advice(module: str) -> str:
    """Return a sentence if a module such as `robot.srv` should have types but no package defines any, or ""."""
    root, _, part = module.partition(".")
    known = packages().get(root)
    if part not in PARTS or (known is not None and any(one.suffix == f".{part}" for one in known.interfaces)):
        return ""
    return _definitions(root, part)


def _definitions(root: str, part: str) -> str:
    """Return a sentence on a package whose imported messages, services or actions are defined nowhere."""
    return (
        f"No package of the workspace {_workspaces()} defines {root}.{part}: put a copy of the package {root}, or only "
        f"its .{part} files in a folder {root}/{part}, into the workspace."
    )


def _workspaces() -> str:
    return " and ".join(str(one.root) for one in workspaces()) or "around the node"


def _in_workspace(root: str) -> str:
    """Return a sentence if the workspace has a package or files of this name, or an empty text."""
    known = packages().get(root)
    if known is not None:
        return (
            f"The package {root} is in the workspace ({known.folder}), but installs no Python module of this name: "
            "name it in packages of its setup.py, or in ament_python_install_package."
        )
    for workspace in workspaces():
        marker = workspace.marker_of(root)
        if marker is not None:
            return (
                f"The package {root} is in the workspace, but {marker} hides it from the build: delete that file, or "
                "put a replacement into sys.modules in the test."
            )
    places = candidates(root)
    if len(places) > 1:
        told = " and ".join(str(one) for one in places[:3])
        return f"No package installs {root}, and more than one file has this name ({told}): name one in a setup.py."
    return ""


def _elsewhere(root: str) -> str:
    """Return a sentence on a module that comes from outside the workspace."""
    if root in _OF_PYTHON_2:
        return PYTHON_2
    missing = f"No package of the workspace {_workspaces()} installs {root}, and it is not installed here"
    replacement = "put a replacement into sys.modules in the test"
    if root in _DEVICES:
        return f"{missing}: it drives a device, so {replacement}."
    if root in _COMPILED:
        return f"{missing}: it is a compiled library of a ROS installation, so {replacement}."
    return f"{missing}: run pip install {_PIP_NAMES.get(root, root)}, or {replacement}."
