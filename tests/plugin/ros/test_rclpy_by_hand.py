"""The parameters and executors of rclpy, one by one and without files of nodes."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest

from pytest_tarl.ros import message_type
from pytest_tarl.ros.process import Network, Process
from pytest_tarl.ros.rclpy.callback_groups import MutuallyExclusiveCallbackGroup, ReentrantCallbackGroup
from pytest_tarl.ros.rclpy.context import Context
from pytest_tarl.ros.rclpy.descriptors import new_descriptor, objection
from pytest_tarl.ros.rclpy.exceptions import (
    InvalidParameterException,
    InvalidParameterTypeException,
    InvalidParameterValueException,
    ParameterAlreadyDeclaredException,
    ParameterImmutableException,
    ParameterNotDeclaredException,
    ParameterUninitializedException,
)
from pytest_tarl.ros.rclpy.executors import (
    Executor,
    ExternalShutdownException,
    MultiThreadedExecutor,
    SingleThreadedExecutor,
)
from pytest_tarl.ros.rclpy.parameter import Parameter, ParameterType
from pytest_tarl.ros.rclpy.parameters import NodeParameters, outcome
from tests.plugin.ros.test_process_by_hand import started

SECOND = 10**9


# parameters


def declared(
    *entries: Any, overrides: dict[str, Any] | None = None, undeclared: bool = False
) -> NodeParameters:
    made = NodeParameters(overrides or {}, undeclared)
    made.declare_parameters("", entries)
    return made


def values(node: NodeParameters) -> dict[str, Any]:
    return {name: one.value for name, one in node._parameters.items() if name != "use_sim_time"}


def test_every_node_has_the_parameter_for_simulated_time() -> None:
    assert declared().get_parameter("use_sim_time").value is False


def test_an_override_takes_precedence_unless_it_is_ignored() -> None:
    node = NodeParameters({"a": 5, "b": 6}, False)
    assert node.declare_parameter("a", 1).value == 5
    assert node.declare_parameter("b", 1, ignore_override=True).value == 1
    assert node.declare_parameter("c", 1).value == 1
    assert (
        node.declare_parameters("ns", ["x", ("y", 2), ("z", 3, new_descriptor(read_only=True))])[1].name
        == "ns.y"
    )
    assert node.has_parameter("ns.z")
    assert not node.has_parameter("z")


def test_a_name_is_declared_once_and_is_not_empty() -> None:
    node = declared(("a", 1))
    with pytest.raises(ParameterAlreadyDeclaredException):
        node.declare_parameter("a", 2)
    for wrong in ("", None):
        with pytest.raises(InvalidParameterException):
            node.declare_parameter(wrong)  # type: ignore[arg-type]


def test_parameter_has_its_declared_type_or_the_default_type() -> None:
    with pytest.raises(InvalidParameterTypeException):
        declared(("a", 1), overrides={"a": 1.5})
    with pytest.raises(InvalidParameterTypeException):
        declared(("a", ParameterType.STRING), overrides={"a": 1})
    node = declared("free", ("a", ParameterType.INTEGER), overrides={"free": "text", "a": 4})
    assert values(node) == {"free": "text", "a": 4}
    assert [node.set_parameters([Parameter("free", value=one)])[0].successful for one in ("x", 1)] == [
        True,
        False,
    ]
    dynamic = declared("free")
    assert dynamic.describe_parameter("free").dynamic_typing
    assert dynamic.set_parameters([Parameter("free", value=1)])[0].successful


def test_a_declared_type_without_a_value_is_uninitialised() -> None:
    node = declared(("a", ParameterType.INTEGER), "free")
    with pytest.raises(ParameterUninitializedException):
        node.get_parameter("a")
    assert node.get_parameter("free").value is None
    assert node.get_parameter_or("a", Parameter("a", value=3)).value == 3
    assert node.get_parameter_or("b").type_ == ParameterType.NOT_SET
    assert node.set_parameters([Parameter("a", value=7)])[0].successful
    assert node.get_parameter("a").value == node.get_parameter_or("a", Parameter("a", value=3)).value == 7
    assert node.get_parameter_type("a") == ParameterType.INTEGER
    assert node.get_parameter_types(["a", "use_sim_time"]) == [ParameterType.INTEGER, ParameterType.BOOL]


def test_unknown_parameter_needs_permission() -> None:
    node, free = declared(), declared(undeclared=True)
    for call in (
        lambda one: one.get_parameter("x"),
        lambda one: one.describe_parameter("x"),
        lambda one: one.set_parameters([Parameter("x", value=1)]),
        lambda one: one.set_parameters_atomically([Parameter("x", value=1)]),
    ):
        with pytest.raises(ParameterNotDeclaredException):
            call(node)  # type: ignore[no-untyped-call]
    assert free.get_parameter("x").value is None
    assert free.describe_parameter("x").name == "x"
    assert free.set_parameters([Parameter("x", value=1)])[0].successful
    assert free.get_parameter("x").value == 1
    assert free.describe_parameter("x").dynamic_typing
    with pytest.raises(ParameterNotDeclaredException):
        free.undeclare_parameter("y")


def test_read_only_parameter_cannot_be_set_or_undeclared() -> None:
    node = declared(("a", 1, new_descriptor(read_only=True)), ("b", 1))
    result = node.set_parameters([Parameter("a", value=2)])[0]
    assert (result.successful, result.reason) == (False, "Trying to set a read-only parameter: a.")
    for call in (lambda: node.undeclare_parameter("a"), lambda: node.set_descriptor("a", new_descriptor())):
        with pytest.raises(ParameterImmutableException):
            call()  # type: ignore[no-untyped-call]
    node.undeclare_parameter("b")
    assert values(node) == {"a": 1}


def test_atomic_change_sets_all_parameters_or_none() -> None:
    changes = [Parameter("a", value=2), Parameter("b", value="text")]
    node = declared(("a", 1), ("b", 1))
    assert not node.set_parameters_atomically(changes).successful
    assert values(node) == {"a": 1, "b": 1}
    assert [one.successful for one in node.set_parameters(changes)] == [True, False]
    assert values(node) == {"a": 2, "b": 1}


def test_newest_parameter_callbacks_run_first() -> None:
    node, trail = declared(("a", 1)), list[Any]()

    def noting(name: str, result: Any = None) -> Callable[[list[Parameter]], Any]:
        def callback(parameters: list[Parameter]) -> Any:
            trail.append((name, [one.value for one in parameters]))
            return parameters if result is None else result

        return callback

    first, second = noting("pre 1"), noting("pre 2")
    refusing, allowing, after = (
        noting("refuse", outcome(False, "no")),
        noting("allow", outcome(True)),
        noting("post"),
    )
    for callback in (first, second):
        node.add_pre_set_parameters_callback(callback)
    node.add_on_set_parameters_callback(refusing)
    node.add_on_set_parameters_callback(allowing)
    node.add_post_set_parameters_callback(after)
    result = node.set_parameters([Parameter("a", value=2)])[0]
    assert (result.successful, result.reason) == (False, "no")
    assert [name for name, _ in trail] == ["pre 2", "pre 1", "allow", "refuse"]
    trail.clear()
    node.remove_on_set_parameters_callback(refusing)
    node.remove_pre_set_parameters_callback(second)
    assert node.set_parameters([Parameter("a", value=3)])[0].successful
    assert trail == [("pre 1", [3]), ("allow", [3]), ("post", [3])]
    node.remove_post_set_parameters_callback(after)
    trail.clear()
    node.set_parameters([Parameter("a", value=4)])
    assert trail == [("pre 1", [4]), ("allow", [4])]


def test_parameter_callback_may_refuse_a_declaration() -> None:
    node = declared(("a", 1))
    node.add_on_set_parameters_callback(lambda _: None)
    result = node.set_parameters([Parameter("a", value=2)])[0]
    assert (result.successful, result.reason) == (False, "Callback returned an invalid type")
    other = NodeParameters({}, False)
    other.add_on_set_parameters_callback(lambda _: outcome(False))
    with pytest.raises(InvalidParameterValueException, match="refused"):
        other.declare_parameter("a", 1)
    assert not other.has_parameter("a")
    other.declare_parameter("free")  # there is no value to refuse


def test_unset_value_removes_a_dynamic_parameter() -> None:
    node = declared(("a", 1, new_descriptor(dynamic_typing=True)), ("b", 1))
    assert node.set_parameters([Parameter("a")])[0].successful
    assert not node.has_parameter("a")
    result = node.set_parameters([Parameter("b")])[0]
    assert (result.successful, result.reason) == (False, "Static parameter cannot be undeclared")


def test_parameters_are_listed_by_their_prefix_and_depth() -> None:
    node = declared(("a.b", 1), ("a.c.d", 2), ("ab", 3), ("a", 4))
    assert {name: one.value for name, one in node.get_parameters_by_prefix("a").items()} == {"b": 1, "c.d": 2}
    assert len(node.get_parameters_by_prefix("")) == 5
    listed = [node.list_parameters(["a"], depth) for depth in (0, 1, 2)]
    assert [one.names for one in listed] == [["a", "a.b", "a.c.d"], ["a", "a.b"], ["a", "a.b", "a.c.d"]]
    assert listed[0].prefixes == ["a", "a.c"]
    assert node.list_parameters([], 1).names == ["a", "ab", "use_sim_time"]


def test_new_descriptor_must_fit_the_value() -> None:
    limits = message_type("rcl_interfaces/msg/IntegerRange")(from_value=0, to_value=4, step=2)
    node = declared(("a", 7))
    with pytest.raises(InvalidParameterValueException):
        node.set_descriptor("a", new_descriptor(integer_range=[limits]))
    assert node.set_descriptor("a", new_descriptor(integer_range=[limits]), 2).integer_value == 2
    assert node.describe_parameters(["a"])[0].type == ParameterType.INTEGER
    assert values(node) == {"a": 2}


def test_all_overrides_are_declared_with_a_dynamic_type() -> None:
    node = NodeParameters({"a": 1, "b": "x"}, False)
    node.declare_parameter("a", 0)
    node.declare_all_overrides()
    assert values(node) == {"a": 1, "b": "x"}
    assert node.set_parameters([Parameter("b", value=2.0)])[0].successful


@pytest.mark.parametrize(
    ("value", "low", "high", "step", "allowed"),
    [
        (0, 0, 4, 2, True),
        (4, 0, 4, 3, True),
        (3, 0, 4, 2, False),
        (3, 0, 4, 0, True),
        (5, 0, 4, 0, False),
        (1, 4, 0, 1, True),
    ],
)
def test_integers_lie_on_range_steps(value: int, low: int, high: int, step: int, allowed: bool) -> None:
    limits = message_type("rcl_interfaces/msg/IntegerRange")(from_value=low, to_value=high, step=step)
    described = new_descriptor(integer_range=[limits], type=int(ParameterType.INTEGER))
    assert (objection(Parameter("a", value=value), described, declaring=False) == "") is allowed


# executors


class Work:
    """An entity of a node that is ready a number of times."""

    def __init__(
        self, name: str, trail: list[Any], times: int = 1, group: Any = None, act: Any = None
    ) -> None:
        self.name, self.trail, self.times, self.callback_group, self.act = name, trail, times, group, act

    def is_ready(self) -> bool:
        return self.times > 0

    def run(self) -> Any:
        self.times -= 1
        self.trail.append(self.name)
        return self.act() if self.act is not None else None


class Timer(Work):
    """A timer with one due instant."""

    def __init__(self, name: str, trail: list[Any], due: int, clock: Any) -> None:
        super().__init__(name, trail)
        self.due, self.canceled, self.clock = due, False, clock

    def is_ready(self) -> bool:
        return self.times > 0 and not self.canceled and self.due <= self.clock.time


class Node:
    """A node with entities, which come first, and timers."""

    def __init__(self, *entities: Any, timers: tuple[Any, ...] = ()) -> None:
        self.entities, self.timers_, self.executor = (timers, entities), timers, None

    def take_executor(self, executor: Any) -> None:
        self.executor = executor


def spinning(
    network: Network,
    program: Callable[[Executor, list[Any]], None],
    kind: Any = SingleThreadedExecutor,
) -> tuple[list[Any], Process]:
    """Run a program with an executor in a node; return what it noted, and its process."""
    trail: list[Any] = []

    def main() -> None:
        made = kind()
        made.context.init()
        program(made, trail)

    process = started(network, main)
    network.scheduler.advance(100 * SECOND)
    if network.scheduler.failure is not None:
        raise network.scheduler.failure
    return trail, process


def test_each_spin_once_runs_one_callback(network: Network) -> None:
    def program(executor: Executor, trail: list[Any]) -> None:
        executor.add_node(Node(Work("a", trail), Work("b", trail)))  # type: ignore[arg-type]
        executor.spin_once()
        trail.append("|")
        executor.spin_once(1.0)
        trail.append(network.scheduler.time)
        executor.spin_once(1.5)
        trail.append(network.scheduler.time)
        executor.spin_once(0)
        trail.append(network.scheduler.time)

    assert spinning(network, program)[0] == ["a", "|", "b", 0, 3 * SECOND // 2, 3 * SECOND // 2]


def test_timers_wake_the_executor(network: Network) -> None:
    clock = network.scheduler

    def program(executor: Executor, trail: list[Any]) -> None:
        late, cancelled = Timer("late", trail, 5, clock), Timer("never", trail, 3, clock)
        cancelled.canceled = True
        now = Timer("now", trail, 0, clock)
        executor.add_node(Node(Work("a", trail), timers=(late, cancelled, now)))  # type: ignore[arg-type]
        for _ in range(3):
            executor.spin_once()
            trail.append(clock.time)

    assert spinning(network, program)[0] == ["now", 0, "a", 0, "late", 5]


def test_spin_ends_with_its_future_or_limit(network: Network) -> None:
    clock = network.scheduler

    def program(executor: Executor, trail: list[Any]) -> None:
        done, never = executor.create_future(), executor.create_future()
        clock.at(7, lambda: done.set_result("x"))
        executor.spin_until_future_complete(done)
        trail.append((done.result(), clock.time))
        executor.spin_until_future_complete(never, 5e-9)
        trail.append((never.done(), clock.time))
        executor.spin_until_future_complete(done)
        for _ in range(2):  # the first one runs the callback of the future that is done
            executor.spin_once_until_future_complete(never, 1e-9)
            trail.append(clock.time)

    assert spinning(network, program)[0] == [("x", 7), (False, 12), 12, 13]


def test_executor_task_runs_before_node_callbacks(
    network: Network,
) -> None:
    def program(executor: Executor, trail: list[Any]) -> None:
        gate = executor.create_future()

        async def coroutine() -> str:
            trail.append("begun")
            await gate
            return "ended"

        made = executor.create_task(coroutine)
        executor.add_node(Node(Work("a", trail)))  # type: ignore[arg-type]
        executor.spin_once()
        executor.spin_once()
        gate.set_result(None)
        executor.spin_until_future_complete(made)
        trail.append(made.result())

    assert spinning(network, program)[0] == ["begun", "a", "ended"]


def test_a_node_belongs_to_one_executor(network: Network) -> None:
    def program(executor: Executor, trail: list[Any]) -> None:
        other, node = SingleThreadedExecutor(), Node()
        trail += [executor.add_node(node), executor.add_node(node), executor.get_nodes() == [node]]  # type: ignore[arg-type]
        trail += [other.add_node(node), executor.get_nodes(), node.executor is other]  # type: ignore[arg-type]
        executor.remove_node(node)  # type: ignore[arg-type]
        trail.append(node.executor is other)
        with other:
            pass
        trail += [node.executor, other.get_nodes()]

    assert spinning(network, program)[0] == [True, False, True, True, [], True, True, None, []]


def test_the_end_of_an_episode_ends_the_spin(network: Network) -> None:
    trail: list[Any] = []

    def main(kind: Any) -> Callable[[], None]:
        def run() -> None:
            made = kind()
            made.context.init()
            try:
                made.spin_once()
                trail.append("returned")
            except ExternalShutdownException:
                trail.append("raised")

        return run

    for kind in (SingleThreadedExecutor, MultiThreadedExecutor):
        process = started(network, main(kind))
        process.end()
    assert trail == ["raised", "returned"]


def test_spin_ends_with_its_context(network: Network) -> None:
    def program(executor: Executor, trail: list[Any]) -> None:
        network.scheduler.at(5, executor.shutdown)
        executor.spin()
        trail.append(network.scheduler.time)
        other = SingleThreadedExecutor()
        network.scheduler.at(9, other.context.shutdown)
        other.spin()
        trail.append(network.scheduler.time)

    assert spinning(network, program)[0] == [5, 9]


def test_multi_threaded_callbacks_overlap_if_allowed(
    network: Network,
) -> None:
    clock = network.scheduler

    def program(executor: Executor, trail: list[Any]) -> None:
        exclusive, free = MutuallyExclusiveCallbackGroup(), ReentrantCallbackGroup()

        def slow() -> None:
            clock.wait(clock.time + 10)
            trail.append(("ended", clock.time))

        works = [
            Work("x1", trail, 1, exclusive, slow),
            Work("x2", trail, 1, exclusive, slow),
            Work("f", trail, 2, free, slow),
        ]
        executor.add_node(Node(*works))  # type: ignore[arg-type]
        clock.at(50, executor.shutdown)
        executor.spin()

    found = spinning(network, program, MultiThreadedExecutor)[0]
    assert [one for one in found if isinstance(one, str)] == ["x1", "f", "f", "x2"]
    assert [one for one in found if not isinstance(one, str)] == [("ended", 10)] * 3 + [("ended", 20)]


def test_a_multi_threaded_executor_has_a_number_of_threads(network: Network) -> None:
    clock = network.scheduler

    def program(executor: Executor, trail: list[Any]) -> None:
        def slow() -> None:
            clock.wait(clock.time + 10)
            trail.append(clock.time)

        executor.add_node(Node(*[Work("w", [], 1, ReentrantCallbackGroup(), slow) for _ in range(3)]))  # type: ignore[arg-type]
        clock.at(90, executor.shutdown)
        executor.spin()

    assert spinning(network, program, lambda: MultiThreadedExecutor(2))[0] == [10, 10, 20]


def test_a_coroutine_occupies_its_group_until_it_returns(network: Network) -> None:
    def program(executor: Executor, trail: list[Any]) -> None:
        group, gate = MutuallyExclusiveCallbackGroup(), executor.create_future()

        async def coroutine() -> None:
            await gate
            trail.append("end of a")

        executor.add_node(Node(Work("a", trail, 1, group, coroutine), Work("b", trail, 1, group)))  # type: ignore[arg-type]
        for _ in range(3):
            executor.spin_once(1e-9)
        trail.append("|")
        gate.set_result(None)
        for _ in range(2):
            executor.spin_once(1e-9)

    assert spinning(network, program)[0] == ["a", "|", "end of a", "b"]


def test_context_is_initialised_once(network: Network) -> None:
    trail: list[Any] = []

    def main() -> None:
        context = Context()
        trail.append((context is Context(), context.ok()))
        with pytest.raises(RuntimeError, match="must be initialized before it can be shutdown"):
            context.shutdown()
        context.init()
        with pytest.raises(RuntimeError, match="must only be called once"):
            context.init()
        context.on_shutdown(lambda: trail.append("callback"))
        trail.append(context.ok())
        context.shutdown()
        context.try_shutdown()
        trail.append(context.ok())
        with context:
            context.init()
        trail.append(context.ok())

    started(network, main)
    assert network.scheduler.failure is None
    assert trail == [(True, False), True, "callback", False, False]
