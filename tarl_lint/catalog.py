"""Functions of ROS and common libraries, as data: what subscribes, publishes, waits, or changes its arguments."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final


@dataclass(frozen=True, slots=True)
class Fact:
    """The effect of one function. Arguments are given by position (a number) or by keyword (a name)."""

    kind: str
    api: str
    topic: tuple[int, str] = (-1, "")
    type: tuple[int, str] = (-1, "")
    callback: tuple[int, str] = (-1, "")
    extra: tuple[int, str] = (-1, "")


NO_FACT: Final = Fact("", "")

ROSPY_SUBSCRIBER = Fact(
    "subscribe", "rospy.Subscriber", (0, "name"), (1, "data_class"), (2, "callback"), (3, "callback_args")
)
ROSPY_PUBLISHER = Fact("publisher", "rospy.Publisher", (0, "name"), (1, "data_class"))
ROSPY_WAIT = Fact("receive", "rospy.wait_for_message", (0, "topic"), (1, "topic_type"))
RCLPY_WAIT = Fact("receive", "rclpy.wait_for_message.wait_for_message", (2, "topic"), (0, "msg_type"))

SIMPLE_ACTION = Fact("action", "actionlib.SimpleActionServer", (0, "name"), (1, "ActionSpec"))
RCLPY_ACTION = Fact("action", "rclpy.action.ActionServer", (2, "action_name"), (1, "action_type"))

FUNCTIONS: Final[Mapping[str, Fact]] = {
    "rospy.Subscriber": ROSPY_SUBSCRIBER,
    "rospy.topics.Subscriber": ROSPY_SUBSCRIBER,
    "rospy.Publisher": ROSPY_PUBLISHER,
    "rospy.topics.Publisher": ROSPY_PUBLISHER,
    "rospy.wait_for_message": ROSPY_WAIT,
    "rospy.client.wait_for_message": ROSPY_WAIT,
    "rclpy.wait_for_message.wait_for_message": RCLPY_WAIT,
    "rospy.Timer": Fact("timer", "rospy.Timer", callback=(1, "callback")),
    "rospy.on_shutdown": Fact("call later", "rospy.on_shutdown", callback=(0, "h")),
    "rospy.Service": Fact("service", "rospy.Service", (0, "name"), (1, "service_class"), (2, "handler")),
    "actionlib.SimpleActionServer": SIMPLE_ACTION,
    "actionlib.simple_action_server.SimpleActionServer": SIMPLE_ACTION,
    "actionlib.ActionServer": Fact("action", "actionlib.ActionServer", (0, "ns"), (1, "ActionSpec")),
    "rclpy.action.ActionServer": RCLPY_ACTION,
    "rclpy.action.server.ActionServer": RCLPY_ACTION,
    "message_filters.Subscriber": Fact(
        "filter", "message_filters.Subscriber", (0, "topic"), (1, "data_class")
    ),
    "message_filters.ApproximateTimeSynchronizer": Fact("synchronizer", "message_filters", (0, "fs")),
    "message_filters.TimeSynchronizer": Fact("synchronizer", "message_filters", (0, "fs")),
    "message_filters.Cache": Fact("synchronizer", "message_filters", (0, "f")),
    "threading.Thread": Fact("thread", "threading.Thread", callback=(1, "target"), extra=(3, "args")),
    "threading.Timer": Fact("thread", "threading.Timer", callback=(1, "function"), extra=(2, "args")),
    "multiprocessing.Process": Fact(
        "thread", "multiprocessing.Process", callback=(1, "target"), extra=(3, "args")
    ),
    "smach_ros.MonitorState": Fact(
        "monitor", "smach_ros.MonitorState", (0, "topic"), (1, "msg_type"), (2, "cond_cb")
    ),
    **{
        f"py_trees_ros.{name}": Fact(
            "behaviour",
            f"py_trees_ros.{name}",
            (1, "topic_name"),
            (2, "topic_type"),
            extra=(4, "blackboard_variables"),
        )
        for name in ("subscribers.ToBlackboard", "subscribers.CheckData", "subscribers.Handler")
    },
    "py_trees_ros.battery.ToBlackboard": Fact(
        "behaviour", "py_trees_ros.battery.ToBlackboard", (1, "topic_name")
    ),
    "functools.partial": Fact("partial", "functools.partial", callback=(0, "func")),
    "copy.copy": Fact("copy", "copy.copy"),
    "copy.deepcopy": Fact("copy", "copy.deepcopy"),
    "rospy.get_param": Fact("parameter", "rospy.get_param", (0, "param_name"), extra=(1, "default")),
    "image_transport.Publisher": Fact("image publisher", "image_transport.Publisher", (0, "topic_uri")),
    "image_transport.Subscriber": Fact(
        "subscribe", "image_transport.Subscriber", (0, "topic_uri"), callback=(1, "callback")
    ),
    "rospy.get_param_cached": Fact(
        "parameter", "rospy.get_param_cached", (0, "param_name"), extra=(1, "default")
    ),
}

# methods that use transforms, in three groups: those that return a transform or transformed data, those that return
# a truth value or a time, and those that return nothing
TRANSFORMING: Final = frozenset(
    ["lookup_transform", "lookup_transform_full", "lookup_transform_async", "lookup_transform_full_async",
     "lookup_transform_core", "lookupTransform", "lookupTransformFull", "lookupTwist", "lookupTwistFull",
     "transformPose", "transformPoint", "transformPointStamped", "transformVector3", "transformPointCloud",
     "transformQuaternion", "asMatrix", "transform_full"]
)  # fmt: skip
ASKING_TRANSFORMS: Final = frozenset(
    ["can_transform", "can_transform_full", "canTransform", "canTransformFull", "frameExists",
     "get_latest_common_time", "getLatestCommonTime"]
)  # fmt: skip
WAITING_TRANSFORMS: Final = frozenset(["waitForTransform", "waitForTransformFull"])
LOOKUPS: Final = TRANSFORMING | ASKING_TRANSFORMS | WAITING_TRANSFORMS
BUFFERS: Final = frozenset(
    ["tf2_ros.Buffer", "tf2_ros.buffer.Buffer", "tf2_ros.BufferClient", "tf2_ros.buffer_client.BufferClient",
     "tf2_ros.BufferInterface", "tf2_ros.buffer_interface.BufferInterface"]
)  # fmt: skip
TRANSFORM: Final = Fact("transform", "tf2.transform")  # source: the method `transform` of BUFFERS
BROADCASTERS: Final = frozenset(
    ["tf.TransformBroadcaster", "tf.broadcaster.TransformBroadcaster", "tf2_ros.TransformBroadcaster",
     "tf2_ros.transform_broadcaster.TransformBroadcaster", "tf2_ros.StaticTransformBroadcaster",
     "tf2_ros.static_transform_broadcaster.StaticTransformBroadcaster"]
)  # fmt: skip
# a file that looks up a transform contains one of these words
LOOKUP_WORDS: Final = (*sorted(LOOKUPS), ".transform(")
MARKER_SERVERS: Final = frozenset(
    [
        "interactive_markers.InteractiveMarkerServer",
        "interactive_markers.interactive_marker_server.InteractiveMarkerServer",
    ]
)  # classes whose callbacks receive what a user does with a marker in RViz
MARKER_MENUS: Final = frozenset(
    ["interactive_markers.MenuHandler", "interactive_markers.menu_handler.MenuHandler"]
)
IMAGE_TRANSPORT: Final = "image_transport_py.ImageTransport"
FEEDBACK: Final = Fact("feedback", "interactive_markers.InteractiveMarkerServer", (0, ""))
CLASS_METHODS: Final[Mapping[str, Fact]] = {
    **{
        f"{server}.{name}": FEEDBACK
        for server in sorted(MARKER_SERVERS)
        for name in ("insert", "setCallback")
    },
    **{f"{menu}.insert": FEEDBACK for menu in sorted(MARKER_MENUS)},
    **{
        f"{IMAGE_TRANSPORT}.{name}": Fact(
            "image publisher", f"{IMAGE_TRANSPORT}.{name}.publish", (0, "base_topic")
        )
        for name in ("advertise", "advertise_camera")
    },
    **{
        f"{IMAGE_TRANSPORT}.{name}": Fact(
            "subscribe", "image_transport_py.Subscriber", (0, "base_topic"), callback=(2, "callback")
        )
        for name in ("subscribe", "subscribe_camera")
    },
    **{f"{buffer}.transform": TRANSFORM for buffer in sorted(BUFFERS)},
    **{
        f"sched.scheduler.{name}": Fact("scheduled", "sched", callback=(2, "action"), extra=(3, "argument"))
        for name in ("enter", "enterabs")
    },
    **{
        f"{broadcaster}.sendTransform": Fact("broadcast", f"{broadcaster}.sendTransform")
        for broadcaster in sorted(BROADCASTERS)
    },
}  # qualified method name → fact; METHODS holds the methods whose name alone identifies them

METHODS: Final[Mapping[str, Fact]] = {
    "create_subscription": Fact(
        "subscribe", "rclpy.create_subscription", (1, "topic"), (0, "msg_type"), (2, "callback")
    ),
    "create_publisher": Fact("publisher", "rclpy.create_publisher", (1, "topic"), (0, "msg_type")),
    "create_lifecycle_publisher": Fact(
        "publisher", "rclpy.create_lifecycle_publisher", (1, "topic"), (0, "msg_type")
    ),
    "advertise": Fact(
        "publisher", "jsk_topic_tools.ConnectionBasedTransport.advertise", (0, "name"), (1, "data_class")
    ),
    "create_timer": Fact("timer", "rclpy.create_timer", callback=(1, "callback")),
    "create_service": Fact(
        "service", "rclpy.create_service", (1, "srv_name"), (0, "srv_type"), (2, "callback")
    ),
    "add_done_callback": Fact("done", "add_done_callback", callback=(0, "callback")),
    "add_on_set_parameters_callback": Fact(
        "call later", "rclpy.add_on_set_parameters_callback", callback=(0, "callback")
    ),
    "declare_parameter": Fact("declare", "rclpy.declare_parameter", (0, "name"), extra=(1, "value")),
    "declare_parameters": Fact(
        "declare all", "rclpy.declare_parameters", (0, "namespace"), extra=(1, "parameters")
    ),
    "get_parameter_or": Fact(
        "parameter or", "rclpy.get_parameter_or", (0, "name"), extra=(1, "alternative_value")
    ),
    "get_parameter": Fact("parameter object", "rclpy.get_parameter", (0, "name")),
    **{name: Fact("transform", f"tf2.{name}") for name in sorted(LOOKUPS)},
    "registerCallback": Fact("register", "message_filters", callback=(0, "cb")),
}
# methods that make a subscription, a publisher, a timer or a service, and are therefore recognised by name alone
ENDPOINT_METHODS: Final = frozenset(
    name for name, fact in METHODS.items() if fact.kind in ("subscribe", "publisher", "timer", "service")
)
# methods of `message_filters.Cache` that return messages
CACHE_READERS: Final = frozenset(
    ["getElemBeforeTime", "getElemAfterTime", "getInterval", "getSurroundingInterval", "getLast"]
)

OTHER_KINDS: Final = (
    "rospy.Service",
    "rclpy.create_service",
    "rclpy.create_client",
    "actionlib.",
    "rclpy.action.",
    "tf2.",
)

FILLS_RESPONSE: Final = frozenset(
    ["rclpy.create_service"]
)  # functions whose handlers get a response object to fill in

# Callbacks of action servers. The callback "goal" gets the goal; all other callbacks get a goal handle. The return
# value of "execute" is the result.
ACTION_CALLBACKS: Final[Mapping[str, Mapping[str, tuple[int, str]]]] = {
    "actionlib.SimpleActionServer": {"goal": (2, "execute_cb")},
    "actionlib.ActionServer": {"accepted": (2, "goal_cb"), "cancel": (3, "cancel_cb")},
    "rclpy.action.ActionServer": {
        "execute": (3, "execute_callback"),
        "goal": (-1, "goal_callback"),
        "accepted": (-1, "handle_accepted_callback"),
        "cancel": (-1, "cancel_callback"),
    },
}
GOAL_FIELD: Final = "request"
GOAL_READERS: Final = frozenset(["accept_new_goal", "get_goal"])
GOAL_REGISTERS: Final = frozenset(["register_goal_callback", "register_preempt_callback"])
ACTION_SENDERS: Final = frozenset(
    ["publish_feedback", "publish_result", "set_succeeded", "set_aborted", "set_preempted", "set_canceled",
     "set_rejected", "succeed", "abort", "canceled"]
)  # fmt: skip

FILTER_WITH_NODE: Final = Fact("filter", "message_filters.Subscriber", (2, "topic"), (1, "msg_type"))

PARAMETER_VALUES: Final = frozenset(
    [
        "value",
        "double_value",
        "integer_value",
        "bool_value",
        "string_value",
        "get_parameter_value",
        "string_array_value",
        "integer_array_value",
        "double_array_value",
        "bool_array_value",
    ]
)

SOURCE_WORDS: Final = (
    "Subscriber",
    "create_subscription",
    "wait_for_message",
    "Service(",
    "create_service",
    "ActionServer",
    "SimpleActionServer",
    "InteractiveMarkerServer",
    "ImageTransport",
    "MonitorState",
    "py_trees_ros",
)  # a file that contains none of these words has no source
SINK_WORDS: Final = ("publish", "Publisher")
CLIENT_WORDS: Final = (
    "ServiceProxy",
    "create_client",
    "ActionClient",
    "SimpleActionClient",
)  # a file that contains none of these words has no client of a service or action

WAITS: Final = frozenset(
    [
        "rospy.sleep", "rospy.spin", "rospy.rostime.wallsleep", "rospy.wait_for_service", "rospy.wait_for_message",
        "rclpy.spin", "rclpy.spin_once", "rclpy.spin_until_future_complete", "time.sleep", "asyncio.sleep",
        "rclpy.wait_for_message.wait_for_message",
    ]
)  # fmt: skip

AWAITING: Final = (
    "asyncio.run", "asyncio.create_task", "asyncio.ensure_future", "asyncio.wait_for", "asyncio.shield",
    "asyncio.run_coroutine_threadsafe",
)  # fmt: skip

IN_THREADS: Final = (
    "asyncio.to_thread", "anyio.to_thread.run_sync", "trio.to_thread.run_sync",
    "starlette.concurrency.run_in_threadpool", "fastapi.concurrency.run_in_threadpool",
)  # fmt: skip

SAME_TEXT: Final = ("rospy.resolve_name", "rospy.remap_name", "rospy.names.resolve_name")
PATH_JOINS: Final = ("rospy.names.ns_join", "roslib.names.ns_join", "os.path.join", "posixpath.join")

WAITING_METHODS: Final = frozenset(
    [
        "sleep", "spin", "spin_once", "spin_until_future_complete", "wait_for_service", "wait_for_server",
        "wait_for_result", "wait", "acquire", "join", "wait_for_message", "send_goal_and_wait",
    ]
)  # fmt: skip

MUTATORS: Final = frozenset(
    [
        "append", "appendleft", "extend", "extendleft", "insert", "add", "update", "put", "put_nowait", "push",
        "fill", "set", "setdefault", "itemset", "write", "push_back", "send", "send_nowait", "clear", "sort",
        "writerow", "writerows",
    ]
)  # fmt: skip

ELEMENT_READERS: Final = frozenset(
    ["pop", "popleft", "get", "get_nowait", "values", "itervalues", "popitem", "setdefault", "next"]
)

PAIR_READERS: Final = frozenset(["items", "iteritems"])

SCALAR_FUNCTIONS: Final = frozenset(
    [
        "abs", "bool", "float", "int", "len", "max", "min", "pow", "round", "str", "sum", "repr", "hash", "ord", "chr",
        "any", "all", "isinstance", "hasattr", "format", "divmod", "type", "id", "input", "bytes", "print",
    ]
)  # fmt: skip

SCALAR_MODULES: Final = ("math.", "time.", "random.", "cmath.", "operator.")

DRAWING: Final = frozenset(
    [
        "circle",
        "line",
        "rectangle",
        "putText",
        "polylines",
        "drawContours",
        "ellipse",
        "fillPoly",
        "arrowedLine",
    ]
)

FILLS_MESSAGES: Final = (
    "genpy.message.fill_message_args", "genpy.fill_message_args", "roslib.message.fill_message_args",
    "rosidl_runtime_py.set_message_fields", "rosidl_runtime_py.set_message.set_message_fields",
)  # fmt: skip
ARGUMENT_WRITERS: Final[Mapping[str, int]] = {
    **{f"cv2.{name}": 0 for name in sorted(DRAWING)},
    "numpy.copyto": 0, "numpy.put": 0, "numpy.place": 0, "numpy.putmask": 0, "random.shuffle": 0,
    "numpy.fill_diagonal": 0, "setattr": 0, "struct.pack_into": 1,
    **dict.fromkeys(FILLS_MESSAGES, 0),
}  # fmt: skip
# method of an object of a library → position of the argument that the method fills with data
METHODS_WRITING: Final = {"pack_into": 0, "readinto": 0, "recv_into": 0}
DEVICE_WRITERS: Final = frozenset(
    ["write", "writelines", "writerow", "writerows", "send", "sendall", "sendto"]
)
DEVICE_READERS: Final = frozenset(
    ["read", "readline", "readlines", "read_until", "read_all", "readinto", "recv", "recvfrom", "recv_into",
     "inWaiting"]
)  # fmt: skip
MEASURES: Final = frozenset(
    ["shape", "size", "ndim", "dtype", "nbytes"]
)  # attributes of an array that stay the same when elements of the array are replaced
# attributes of a table or array through which its own elements are read and stored, as in `table.loc[3] = x`
INDEXERS: Final = frozenset(["loc", "iloc", "at", "iat", "flat"])
KEEPERS: Final = frozenset(
    [
        "functools.wraps",
        "functools.update_wrapper",
        "builtins.print",
        "builtins.repr",
        "builtins.id",
        "builtins.hash",
        "inspect.signature",
        "inspect.getfullargspec",
        "inspect.iscoroutinefunction",
        "asyncio.iscoroutinefunction",
    ]
)  # library functions that never call the functions passed to them
MAY_BE_NONE: Final = frozenset(
    [
        "get",
        "match",
        "search",
        "fullmatch",
        "find",
        "imread",
        "HoughLines",
        "HoughLinesP",
        "HoughCircles",
        "getenv",
    ]
)  # library functions that return None if they find nothing
# keywords of the arguments into which numpy and cv2 write results
WRITTEN_KEYWORDS: Final = frozenset(["out", "dst"])

# package whose classes are bases of states; a state that runs receives the data shared by all states
STATES: Final = "smach"
RUNS_STATE: Final = "execute"
ADDS_STATE: Final = (
    *(f"smach.{machine}.add" for machine in ("StateMachine", "Sequence", "Concurrence", "Container")),
    "smach.StateMachine.add_auto", "smach.Iterator.set_contained_state",
)  # fmt: skip
STATE_BY_CALLBACKS: Final = (
    "smach.CBState", "smach.state.CBState", "smach_ros.SimpleActionState", "smach_ros.ServiceState",
    "smach_ros.ConditionState",
)  # fmt: skip

NODES: Final = frozenset(["rclpy.node.Node", "rclpy.lifecycle.Node", "rclpy.lifecycle.LifecycleNode"])
TRANSFORMS: Final = frozenset(
    [
        "builtins",
        "numpy",
        "numba",
        "torch",
        "jax",
        "tensorflow",
        "pytest",
        "hypothesis",
        "beartype",
        "typeguard",
        "overrides",
        "deprecated",
        "attr",
        "attrs",
        "pydantic",
        "tenacity",
        "retry",
        "backoff",
        "decorator",
        "wrapt",
    ]
)  # packages whose decorators change a function, but register it nowhere
TESTS: Final = frozenset(
    ["unittest.TestCase", "unittest.case.TestCase"]
)  # a test runner creates objects of these classes
NODE_BASES: Final = NODES | frozenset(
    [
        "object", "Exception",
        "enum.Enum", "enum.IntEnum", "abc.ABC", "typing.NamedTuple", "typing.Protocol", "threading.Thread",
    ]
)  # fmt: skip

SHAPED: Final = frozenset(
    ["zeros_like", "ones_like", "empty_like", "full_like"]
)  # functions that use only the shape of their first argument, not its data

RESERVING: Final = frozenset(
    ["numpy.zeros", "numpy.ones", "numpy.empty", "numpy.full", "builtins.bytearray"]
    + [f"numpy.{name}" for name in SHAPED]
)  # functions that make an array without data; often a library fills the array later

# methods that return a clock; the time of a clock is not data of the object that has the method
CLOCKS: Final = frozenset(["get_clock"])

LEVELS: Final = frozenset(
    ["debug", "info", "warn", "warning", "error", "fatal", "critical"]
)  # logging methods that are named after levels
LOGGING: Final = LEVELS | {"get_logger", "exception", "log"}


def on_topic(api: str) -> bool:
    """Return whether a source or sink belongs to a topic, not to a service, action or transform."""
    return not api.startswith(OTHER_KINDS)


def fact(qualified: str) -> Fact | None:
    """Return the fact about a library function or class; None if there is none."""
    return FUNCTIONS.get(qualified)


def written(qualified: str) -> int | None:
    """Return the position of the argument that a function changes; None if it changes none."""
    if qualified.startswith("numpy.") and qualified.endswith(".at"):  # numpy.add.at(array, places, values)
        return 0
    return ARGUMENT_WRITERS.get(qualified)


def scalar(qualified: str) -> bool:
    """Return whether a function returns a plain value, not an object that could be changed later."""
    name = qualified.removeprefix("builtins.")
    return name in SCALAR_FUNCTIONS or qualified.startswith(SCALAR_MODULES)
