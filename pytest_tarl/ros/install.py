"""Put the stand-ins where a node's imports find them, and take them away again."""

from __future__ import annotations

import sys
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from importlib import import_module
from importlib.machinery import ModuleSpec
from types import CodeType, FrameType, ModuleType
from typing import TYPE_CHECKING

from pytest_tarl.ros.hosttime import virtual_host_time
from pytest_tarl.ros.messages.definitions import Kind
from pytest_tarl.ros.messages.installed import installed_kind
from pytest_tarl.ros.messages.packages import could_be_package, is_package, package_module
from pytest_tarl.ros.missing import refusing, unsupported
from pytest_tarl.ros.threads import threads_as_tasks

if TYPE_CHECKING:
    from pytest_tarl.ros.episode import Ros

_HOME = "pytest_tarl.ros."
STANDINS: Mapping[str, str] = {  # what a node imports → what it gets
    "rospy": "rospy",
    "rospy.exceptions": "rospy.exceptions",
    "rospy.rostime": "rospy.timing",
    "rospy.timer": "rospy.timing",
    "rospy.numpy_msg": "rospy.numpy_msg",
    "genpy": "genpy",
    "genpy.rostime": "genpy",
    "genpy.message": "genpy",
    "roslib": "roslib",
    "rclpy": "rclpy",
    "rclpy.callback_groups": "rclpy.callback_groups",
    "rclpy.client": "rclpy.services",
    "rclpy.clock": "rclpy.time",
    "rclpy.duration": "rclpy.time",
    "rclpy.exceptions": "rclpy.exceptions",
    "rclpy.executors": "rclpy.executors",
    "rclpy.logging": "rclpy.logging",
    "rclpy.node": "rclpy.node",
    "rclpy.parameter": "rclpy.parameter",
    "rclpy.publisher": "rclpy.topics",
    "rclpy.qos": "rclpy.qos",
    "rclpy.service": "rclpy.services",
    "rclpy.subscription": "rclpy.topics",
    "rclpy.task": "rclpy.task",
    "rclpy.time": "rclpy.time",
    "rclpy.timer": "rclpy.timer",
    "rclpy.utilities": "rclpy",
    "message_filters": "message_filters",
    "tf.transformations": "transformations",
    "tf_transformations": "transformations",
}
_TALKING = ("rospy", "rclpy", "genpy", "roslib", "message_filters", "tf", "tf_transformations")
_MISSING = ("tf2_ros", "tf2_py", "actionlib", "rosgraph", "rospkg", "rosnode", "rostopic", "dynamic_reconfigure",
            "moveit_commander", "ament_index_python", "rcl_interfaces.srv", "image_transport")  # fmt: skip
_STANDALONE = (
    "cv_bridge",
    "rospkg",
    "ament_index_python",
)  # work without a running ROS, so a real one is fine


class StandinFinder:
    """A finder for `sys.meta_path`. Every episode gets module objects of its own."""

    def __init__(self) -> None:
        self.loaded: list[str] = []
        self.hidden: dict[str, ModuleType] = {}
        self._kind: Kind | None = None

    def find_spec(
        self, name: str, _path: Sequence[str] | None = None, _target: ModuleType | None = None
    ) -> ModuleSpec | None:
        """Find a stand-in; None leaves the name to the other finders."""
        root = name.partition(".")[0]
        if root in _TALKING or root in _MISSING:
            return self._spec(name)
        if not could_be_package(root):
            return None
        kind = self._kind_of_importer()
        return self._spec(name) if installed_kind(root) != kind and is_package(kind, root) else None

    def create_module(self, spec: ModuleSpec) -> ModuleType:
        """Make a module object that nobody has seen before."""
        name = spec.name
        if name in STANDINS:
            home = import_module(_HOME + STANDINS[name])
            module = ModuleType(name, home.__doc__)
            module.__dict__.update(
                {key: value for key, value in vars(home).items() if not _is_import_data(key)}
            )
        elif name == "tf":
            module = ModuleType(name)
            module.__dict__["__getattr__"] = refusing("tf")
        else:
            made = package_module(self._kind or "ros2", name)
            if made is None:
                raise unsupported(name)
            module = made
        module.__path__ = []
        self.loaded.append(name)
        return module

    def exec_module(self, module: ModuleType) -> None:
        """Do nothing: the module is complete."""

    def _spec(self, name: str) -> ModuleSpec:
        root = name.partition(".")[0]
        if self._kind is None and root in ("rospy", "rclpy"):
            self._settle_kind("ros1" if root == "rospy" else "ros2")
        if root in _TALKING and name not in STANDINS and name != "tf":
            raise unsupported(name)
        if name in _MISSING:
            raise unsupported(name)
        return ModuleSpec(name, self, origin="pytest_tarl.ros", is_package=True)  # type: ignore[arg-type]

    def _kind_of_importer(self) -> Kind:
        """Tell for which ROS generation messages are wanted: that of the client library which the importer names."""
        if self._kind is None:
            return self._settle_kind(_kind_named_by(sys._getframe(2)) or "ros2")
        return self._kind

    def _settle_kind(self, kind: Kind) -> Kind:
        """Fix the ROS generation of this episode's messages; those of an installed other one get out of the way."""
        self._kind = kind
        if installed_kind("std_msgs") not in (None, kind):
            self.hidden.update(_hide({name for name in sys.modules if could_be_package(name)}))
        return kind


def _kind_named_by(frame: FrameType | None) -> Kind | None:
    while frame is not None:
        named = _imports(frame.f_code)
        if "rospy" in named:
            return "ros1"
        if "rclpy" in named:
            return "ros2"
        frame = frame.f_back
    return None


def _imports(code: CodeType) -> set[str]:
    return {name.partition(".")[0] for name in code.co_names}


def _is_import_data(key: str) -> bool:
    return key in ("__name__", "__doc__", "__spec__", "__loader__", "__file__", "__cached__", "__path__", "__package__",
                   "__builtins__")  # fmt: skip


@contextmanager
def standins_installed(ros: Ros) -> Iterator[None]:
    """Have imports find the stand-ins and nodes see the virtual clock as the host's; undo all of it on exit."""
    finder = StandinFinder()
    finder.hidden = _hide(_TALKING)
    sys.meta_path.insert(0, finder)
    try:
        with virtual_host_time(ros.scheduler), threads_as_tasks():
            yield
    finally:
        sys.meta_path.remove(finder)
        for name in finder.loaded:
            sys.modules.pop(name, None)
        sys.modules.update(finder.hidden)


def _hide(roots: Iterable[str]) -> dict[str, ModuleType]:
    """Take the modules of a real ROS, or of another stand-in, out of the way."""
    present = {root for root in roots if root in sys.modules}
    names = [name for name in sys.modules if name.partition(".")[0] in present] if present else []
    return {name: sys.modules.pop(name) for name in names}
