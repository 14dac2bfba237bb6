"""Check whether a program imports only modules that use no topics and parameters on their own."""

from __future__ import annotations

import ast
import re
import sys
from collections.abc import Iterator, Sequence
from typing import Final

from tarl_lint.read.source import Module

_QUIET: Final = frozenset(
    ["rospy", "rclpy", "message_filters", "actionlib", "cv_bridge", "roslib", "rospkg", "rosgraph", "genpy",
     "rosbag", "ament_index_python", "builtin_interfaces", "angles", "transforms3d", "dynamic_reconfigure",
     "tf_transformations", "sensor_msgs_py", "laser_geometry", "image_geometry", "ros_numpy", "ros2_numpy",
     "tf2_sensor_msgs", "tf2_kdl", "PyKDL", "urdf_parser_py", "xacro", "diagnostic_updater", "smach", "py_trees",
     "rosidl_runtime_py", "resource_retriever", "cv2", "numpy", "scipy", "yaml", "matplotlib", "PIL", "serial",
     "pandas", "torch", "torchvision", "sklearn", "skimage", "tensorflow", "keras", "onnxruntime",
     "tflite_runtime", "ultralytics", "mediapipe", "numba", "casadi", "cvxpy", "osqp", "sympy", "networkx",
     "shapely", "filterpy", "gtsam", "open3d", "trimesh", "pyproj", "utm", "geographiclib", "pymap3d",
     "quaternion", "pyquaternion", "transformations", "six", "future", "attr", "attrs", "pydantic", "jsonschema",
     "psutil", "tqdm", "click", "requests", "flask", "aiohttp", "websocket", "websockets", "zmq", "msgpack",
     "paho", "simple_pid", "smbus", "smbus2", "spidev", "RPi", "gpiozero", "pigpio", "board", "busio",
     "digitalio", "Jetson", "usb", "bluetooth", "evdev", "pygame", "pynput", "can", "pymodbus", "minimalmodbus",
     "pynmea2", "dynamixel_sdk", "pyrealsense2", "depthai", "apriltag", "pupil_apriltags", "pyzbar", "pyaudio",
     "sounddevice", "pyttsx3", "gtts", "playsound", "speech_recognition", "vosk", "whisper", "openai", "pytz",
     "dateutil"]
)  # fmt: skip
_INTERFACES: Final = re.compile(r"\w+_(msgs|srvs|interfaces|actions?|msg|srv)$")
_TRANSFORMS: Final = frozenset(
    ["tf", "tf2_ros", "tf2_py", "tf2_geometry_msgs"]
)  # packages whose code communicates by /tf, which no rule examines


_NO_PARAMETERS: Final = frozenset(
    [
        "smach_ros",
        "actionlib_tutorials",
        "rosservice",
        "rosnode",
        "rostopic",
        "rosmsg",
        "tf_conversions",
        "tf2_tools",
        "interactive_markers",
        "rviz_tools_py",
        "rqt_gui_py",
        "cv_bridge",
    ]
)  # packages whose code uses topics, but reads no parameter of the node


def closed(modules: Sequence[Module], *, of_parameters: bool = False) -> bool:
    """Return whether the modules import only each other, modules without topics, and packages of messages.

    `of_parameters` asks for modules without parameters instead of modules without topics.
    """
    own = {part for module in modules for part in (module.name, module.name.partition(".")[0])}
    own |= {module.name.rpartition(".")[2] for module in modules}
    if of_parameters:
        own |= _NO_PARAMETERS
    return all(_quiet(name, own) for module in modules for name in _imported(module.tree))


def _quiet(name: str, own: set[str]) -> bool:
    first, _, rest = name.partition(".")
    if rest.partition(".")[0] in ("msg", "srv", "action", "cfg") or _INTERFACES.match(first):
        return True
    return first in own or first in _QUIET or first in _TRANSFORMS or first in sys.stdlib_module_names


def _imported(tree: ast.Module) -> Iterator[str]:
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and node.module and not node.level:
            yield node.module
