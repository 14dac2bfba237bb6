"""Patch rclpy: its waits, clocks and context, with hooks for sent messages.

Executors, callbacks, parameters, profiles, messages and the middleware stay unchanged. Outside node tasks, every
replaced function calls the original.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from pytest_tarl.realros.lockstep import PATIENCE
from pytest_tarl.realros.rclpy_context import shared_context
from pytest_tarl.realros.rclpy_network import pause
from pytest_tarl.ros.clock import nanoseconds
from pytest_tarl.ros.hosttime import REAL_MONOTONIC
from pytest_tarl.ros.names import absolute
from pytest_tarl.ros.process import running_process
from pytest_tarl.ros.scheduler import Task, running_task

if TYPE_CHECKING:
    from pytest_tarl.realros.rclpy_network import RclpyNetwork


def patch(network: RclpyNetwork) -> None:
    """Patch rclpy to run in lock-step until the process exits."""
    _patch_context(network)
    _patch_nodes(network)
    _patch_clocks(network)
    _patch_executors(network)
    _patch_topics(network)
    _patch_sending(network)
    _patch_calls(network)
    _patch_rates(network)


def _patch_context(network: RclpyNetwork) -> None:
    rclpy = network.rclpy
    shared = shared_context(network)
    rclpy.utilities.__dict__["Context"] = shared
    rclpy.context.__dict__["Context"] = shared
    rclpy.__dict__["Context"] = shared
    rclpy.__dict__["install_signal_handlers"] = lambda *_: None
    rclpy.__dict__["uninstall_signal_handlers"] = lambda: None


def _patch_nodes(network: RclpyNetwork) -> None:
    node_class = network.rclpy.node.Node
    make, destroy = node_class.__init__, node_class.destroy_node

    def init(self: Any, node_name: str, **options: Any) -> None:
        process = running_process()
        if process is None:
            make(self, node_name, **options)
            return
        if options.get("use_global_arguments", True):
            own = list(options.get("cli_args") or ())
            options["cli_args"] = own + ros_arguments((*process.argv[1:], *network.arguments))
        given = _parameters(network, node_name, options)
        options["parameter_overrides"] = [*given, *(options.get("parameter_overrides") or ())]
        make(self, node_name, **options)
        network.nodes.append((process, self))
        process.label = self.get_fully_qualified_name()

    def end(self: Any) -> Any:
        network.nodes[:] = [(process, node) for process, node in network.nodes if node is not self]
        for subscription in self.subscriptions:
            network.expected.pop(subscription, None)
        for publisher in self.publishers:
            network.kept.pop(publisher, None)
        return destroy(self)

    node_class.__init__, node_class.destroy_node = init, end


def ros_arguments(argv: tuple[str, ...]) -> list[str]:
    """Return the arguments between `--ros-args` and `--`."""
    found, inside = [], False
    for argument in argv:
        if argument == "--ros-args":
            inside = True
        elif argument == "--":
            inside = False
        elif inside:
            found.append(argument)
    return found


def _parameters(network: RclpyNetwork, name: str, options: dict[str, Any]) -> list[Any]:
    """Return the test's parameters for a node: those for all nodes, then those for its name."""
    own = absolute(f"{options.get('namespace') or ''}/{name}") + "/"
    found = {}
    for key, value in network.parameters.items():
        if not key.startswith("/"):
            found[key.removeprefix("~")] = value
        elif key.startswith(own):
            found[key.removeprefix(own)] = value
    return [network.rclpy.parameter.Parameter(key, value=value) for key, value in found.items()]


def _patch_clocks(network: RclpyNetwork) -> None:
    source, clock_class = network.rclpy.time_source.TimeSource, network.rclpy.clock.Clock
    attach, now, sleep_until = source.attach_clock, clock_class.now, clock_class.sleep_until

    def attach_clock(self: Any, clock: Any) -> None:
        attach(self, clock)
        if running_task() is not None:
            clock.set_ros_time_override(_time(network, clock))
            clock._set_ros_time_is_active(True)
            network.clocks.append(clock)

    def read(self: Any) -> Any:
        return now(self) if running_task() is None else _time(network, self)

    def wait_until(self: Any, until: Any, context: Any = None) -> Any:
        task = running_task()
        if task is None:
            return sleep_until(self, until, context)
        if until.clock_type != self.clock_type:
            raise ValueError("until's clock type does not match this clock's type")
        while network.scheduler.time < until.nanoseconds and not task.process.ending:
            network.scheduler.wait(until.nanoseconds)
        return network.scheduler.time >= until.nanoseconds

    source.attach_clock, clock_class.now, clock_class.sleep_until = attach_clock, read, wait_until
    _patch_timers(network)


def _patch_timers(network: RclpyNetwork) -> None:
    node_class = network.rclpy.node.Node
    create = node_class.create_timer

    def create_timer(self: Any, *args: Any, **options: Any) -> Any:
        if running_task() is not None:
            options.pop(
                "clock", None
            )  # all clock types show virtual time: a steady clock would go on while the simulation pauses
        return create(self, *args, **options)

    node_class.create_timer = create_timer


def _time(network: RclpyNetwork, clock: Any) -> Any:
    return network.rclpy.time.Time(nanoseconds=network.scheduler.time, clock_type=clock.clock_type)


def _patch_executors(network: RclpyNetwork) -> None:
    executors = network.rclpy.executors
    base, threaded = executors.Executor, executors.MultiThreadedExecutor
    look, take, wake, make = (
        base.wait_for_ready_callbacks,
        base._take_subscription,
        base.wake,
        threaded.__init__,
    )

    def wait(self: Any, timeout: Any = None, nodes: Any = None, condition: Callable[[], bool] = bool) -> Any:
        task = running_task()
        if task is None:
            return look(self, timeout, nodes, condition)
        clock = network.scheduler
        seconds = getattr(timeout, "timeout", timeout)
        until = None if seconds is None or seconds < 0 else clock.time + nanoseconds(seconds)
        deadline = REAL_MONOTONIC() + PATIENCE
        while True:
            _raise_if_ended(self, task, executors)
            if network.under_way(self) and REAL_MONOTONIC() < deadline:
                pause()
                continue
            try:
                return look(self, 0, nodes, condition)
            except executors.TimeoutException:
                if until is not None and clock.time >= until:
                    raise
            network.listening.append(task)
            clock.wait(_earliest(self, clock.time, until))
            deadline = REAL_MONOTONIC() + PATIENCE

    def take_subscription(self: Any, subscription: Any) -> Any:
        network.taken(subscription)
        return take(self, subscription)

    def awake(self: Any) -> None:
        wake(self)
        network.wake_listening()

    def init(self: Any, *args: Any, **options: Any) -> None:
        make(self, *args, **options)
        if running_task() is not None:
            self._executor = TaskPool(network)

    base.wait_for_ready_callbacks, base._take_subscription, base.wake = wait, take_subscription, awake
    threaded.__init__ = init


def _raise_if_ended(executor: Any, task: Task, executors: Any) -> None:
    if task.process.ending:
        task.process.refuse_to_wait()
    if not executor.context.ok():
        ended = executors.ExternalShutdownException()
        ended.tarl_shutdown = task.process.ending
        raise ended


def _earliest(executor: Any, now: int, until: int | None) -> int | None:
    """Return when the next timer of the executor's nodes is due, or `until` if that is earlier."""
    due = [] if until is None else [until]
    for node in executor.get_nodes():
        for timer in node.timers:
            remaining = None if timer.is_canceled() else timer.time_until_next_call()
            if remaining is not None and remaining > 0:
                due.append(now + remaining)
    return min(due, default=None)


class TaskPool:
    """The pool of a multi-threaded executor: it starts tasks instead of threads."""

    def __init__(self, network: RclpyNetwork) -> None:
        self._network = network

    def submit(self, handler: Callable[[], Any]) -> None:
        """Run a callback in its own task."""
        task = running_task()
        if task is None:
            handler()
            return
        self._network.scheduler.spawn(task.process, self._run, handler)

    def shutdown(self, wait: bool = True) -> None:
        """Do nothing: tasks end with the process."""

    def _run(self, handler: Callable[[], Any]) -> None:
        try:
            handler()
        finally:
            self._network.wake_listening()


def _patch_topics(network: RclpyNetwork) -> None:
    node_class = network.rclpy.node.Node
    create_publisher, create_subscription = node_class.create_publisher, node_class.create_subscription

    def publisher(self: Any, message_class: Any, *args: Any, **options: Any) -> Any:
        made = create_publisher(self, message_class, *args, **options)
        if _of_node(made.topic_name) and network.node_publishes is not None:
            network.node_publishes(made.topic_name, message_class, made.qos_profile)
        return made

    def subscription(self: Any, *args: Any, **options: Any) -> Any:
        made = create_subscription(self, *args, **options)
        if _of_node(made.topic_name) and network.node_subscribes is not None:
            network.node_subscribes(made.topic_name)
            network.joined(made)
        return made

    node_class.create_publisher, node_class.create_subscription = publisher, subscription


def _of_node(topic: str) -> bool:
    """Return whether the node's program created an entity; rclpy itself creates some in every node."""
    return running_task() is not None and topic not in ("/rosout", "/parameter_events", "/clock")


def _patch_sending(network: RclpyNetwork) -> None:
    rclpy = network.rclpy
    publisher, trigger = rclpy.publisher.Publisher, rclpy.guard_condition.GuardCondition
    publish, pull = publisher.publish, trigger.trigger

    def send(self: Any, message: Any) -> None:
        publish(self, message)
        network.sent(self)

    def wake(self: Any) -> None:
        pull(self)
        network.wake_listening()

    publisher.publish, trigger.trigger = send, wake


def _patch_calls(network: RclpyNetwork) -> None:
    client, service = network.rclpy.client.Client, network.rclpy.service.Service
    call, call_async, respond = client.call, client.call_async, service.send_response

    def ask_async(self: Any, request: Any) -> Any:
        future = call_async(self, request)
        network.wake_listening()
        return future

    def answer(self: Any, response: Any, header: Any) -> None:
        respond(self, response, header)
        network.wake_listening()

    def ask(self: Any, request: Any, timeout_sec: float | None = None) -> Any:
        task = running_task()
        if task is None:
            return call(self, request, timeout_sec)
        clock = network.scheduler
        until = None if timeout_sec is None else clock.time + nanoseconds(timeout_sec)
        future = ask_async(self, request)
        future.add_done_callback(lambda _: clock.wake(task))
        while not future.done() and not task.process.ending:
            if until is not None and clock.time >= until:
                self.remove_pending_request(future)
                raise TimeoutError
            clock.wait(until)
        if future.exception() is not None:
            raise future.exception()
        return future.result()

    client.call, client.call_async, service.send_response = ask, ask_async, answer


def _patch_rates(network: RclpyNetwork) -> None:
    rate = network.rclpy.timer.Rate
    sleep = rate.sleep

    def wait(self: Any) -> None:
        task = running_task()
        if task is None:
            sleep(self)
            return
        self._presleep()
        try:
            while not self._event.is_set() and not task.process.ending:
                network.listening.append(task)
                network.scheduler.wait()
        finally:
            self._postsleep()

    rate.sleep = wait
