"""Patch a node's copy of rospy: waits, sent and received messages, initialisation and shutdown.

The rest of rospy stays unchanged. Outside node tasks, replaced functions call the original.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any

from pytest_tarl.realros.lockstep import Way
from pytest_tarl.ros.clock import NANOSECONDS, nanoseconds
from pytest_tarl.ros.process import Process, running_process
from pytest_tarl.ros.scheduler import Task, running_task

if TYPE_CHECKING:
    from pytest_tarl.realros.rospy_copy import RospyCopy
    from pytest_tarl.realros.rospy_network import RospyNetwork

# the real functions, saved because nodes get the virtual clock under these names
REAL_TIME = SimpleNamespace(
    time=time.time, sleep=time.sleep, monotonic=time.monotonic, perf_counter=time.perf_counter,
    strftime=time.strftime, localtime=time.localtime, gmtime=time.gmtime)  # fmt: skip
_ON_REAL_TIME = ("core", "topics", "impl.init", "impl.registration", "impl.tcpros_base", "impl.tcpros_pubsub")


def patch(copy: RospyCopy, network: RospyNetwork) -> None:
    """Patch a copy of rospy to run in lock-step."""
    for part in _ON_REAL_TIME:
        copy.modules[f"rospy.{part}"].__dict__["time"] = REAL_TIME
    # rospy's logging configuration would remove pytest's handlers
    copy.core.__dict__["configure_logging"] = lambda *_, **__: None
    _patch_clock(copy)
    _patch_waits(copy, network)
    _patch_timers(copy)
    _patch_end(copy)
    _patch_beginning(copy, network)
    _patch_sending(copy, network)
    _patch_receiving(copy, network)
    _patch_connecting(copy, network)
    _patch_services(copy, network)


def _replace(copy: RospyCopy, part: str, name: str, make: Callable[[Callable[..., Any]], Any]) -> None:
    """Replace a function in a module and in the `rospy` namespace."""
    module = copy.modules[f"rospy.{part}"]
    original = copy.real[name] = getattr(module, name)
    module.__dict__[name] = made = make(original)
    if getattr(copy.rospy, name, None) is original:
        copy.rospy.__dict__[name] = made


def _patch_clock(copy: RospyCopy) -> None:
    def make(original: Callable[[], Any]) -> Callable[[], Any]:
        def get_rostime() -> Any:
            process = running_process()
            if process is not None and copy.rostime.is_rostime_initialized():
                copy.rostime.__dict__["_rostime_current"] = copy.rostime.Time(
                    *divmod(process.scheduler.time, NANOSECONDS)
                )
            return original()

        return get_rostime

    _replace(copy, "rostime", "get_rostime", make)


def _patch_waits(copy: RospyCopy, network: RospyNetwork) -> None:
    def make_sleep(original: Callable[[Any], None]) -> Callable[[Any], None]:
        def sleep(duration: Any) -> None:
            process = running_process()
            if process is None:
                original(duration)
                return
            copy.rostime.get_rostime()  # raises before init_node
            span = duration.to_nsec() if hasattr(duration, "to_nsec") else nanoseconds(duration)
            _sleep(copy, network, process, process.scheduler.time + span)

        return sleep

    def make_wallsleep(original: Callable[[float], None]) -> Callable[[float], None]:
        def wallsleep(duration: float) -> None:
            process = running_process()
            if process is None:
                original(duration)
            elif process.ending:
                process.refuse_to_wait()
            else:
                network.listening.append(_task())
                process.scheduler.wait(process.scheduler.time + nanoseconds(duration))

        return wallsleep

    _replace(copy, "timer", "sleep", make_sleep)
    _replace(copy, "rostime", "wallsleep", make_wallsleep)
    copy.tcp_services.__dict__["time"] = SimpleNamespace(
        time=lambda: time.time(), sleep=lambda duration: copy.rostime.wallsleep(duration)
    )


def _sleep(copy: RospyCopy, network: RospyNetwork, process: Process, until: int) -> None:
    if process.ending:
        process.refuse_to_wait()
        if network.in_hooks:
            return  # virtual time stands still in shutdown hooks
    elif until >= process.scheduler.time:
        process.scheduler.wait(until)
    if process.ending:
        raise copy.rospy.ROSInterruptException("ROS shutdown request")


def _patch_timers(copy: RospyCopy) -> None:
    timer = copy.timer.Timer
    start, join, is_alive = timer.start, timer.join, timer.is_alive

    def begin(self: Any) -> None:
        process = running_process()
        if process is None:
            start(self)
        else:
            self.tarl_task = process.scheduler.spawn(process, self.run)

    def alive(self: Any) -> bool:
        return not self.tarl_task.done if hasattr(self, "tarl_task") else bool(is_alive(self))

    def wait(self: Any, timeout: float | None = None) -> None:
        if not hasattr(self, "tarl_task"):
            join(self, timeout)
            return
        clock = self.tarl_task.process.scheduler
        until = None if timeout is None else clock.time + nanoseconds(timeout)
        while not self.tarl_task.done and (until is None or clock.time < until):
            clock.wait(clock.time + self._period.to_nsec() if until is None else until)

    timer.start, timer.is_alive, timer.join = begin, alive, wait


def _patch_end(copy: RospyCopy) -> None:
    def make_is_shutdown(original: Callable[[], bool]) -> Callable[[], bool]:
        def is_shutdown() -> bool:
            process = running_process()
            return original() if process is None else process.ending

        return is_shutdown

    def make_signal_shutdown(original: Callable[[str], None]) -> Callable[[str], None]:
        def signal_shutdown(reason: str) -> None:
            process = running_process()
            if process is None:
                original(reason)
            elif not process.ending:
                process.ask_to_end()

        return signal_shutdown

    _replace(copy, "core", "is_shutdown", make_is_shutdown)
    _replace(copy, "core", "signal_shutdown", make_signal_shutdown)


def _patch_beginning(copy: RospyCopy, network: RospyNetwork) -> None:
    def make(original: Callable[..., None]) -> Callable[..., None]:
        def init_node(name: str, *args: Any, **kwargs: Any) -> None:
            if running_process() is None:
                original(name, *args, **kwargs)
            else:
                network.initialise(copy, name, args, kwargs)

        return init_node

    _replace(copy, "client", "init_node", make)


def _patch_sending(copy: RospyCopy, network: RospyNetwork) -> None:
    publisher = copy.topics._PublisherImpl
    original = publisher.publish

    def publish(self: Any, message: Any, connection_override: Any = None) -> Any:
        if connection_override is not None and message is self.latch:
            # rospy would send the latched message to a new subscriber again, after `latched` did
            return None
        connections = self.connections if connection_override is None else [connection_override]
        ways = [Way(self.resolved_name, copy.name, connection.endpoint_id) for connection in connections]
        for way in ways:
            network.wire.wait_for_all(way)
        try:
            result = original(self, message, connection_override)
        except BaseException:  # rospy would leave half a message in its buffer and break the connection
            self.buff.seek(0)
            self.buff.truncate(0)
            raise
        for way in ways:
            network.sent(way)
        return result

    publisher.publish = publish


def _patch_receiving(copy: RospyCopy, network: RospyNetwork) -> None:
    subscriber = copy.topics._SubscriberImpl
    add_callback, make = subscriber.add_callback, subscriber.__init__

    def receive_callback(self: Any, messages: list[Any], connection: Any) -> None:
        for message in messages:
            network.wire.arrived(Way(self.resolved_name, connection.callerid_pub, copy.name), (self, message))

    def add(self: Any, callback: Any, arguments: Any) -> None:
        connections, self.connections = (
            self.connections,
            [],
        )  # latched messages are delivered in order, not at once
        try:
            add_callback(self, callback, arguments)
        finally:
            self.connections = connections
        network.latched(copy, self, callback, arguments)

    def init(self: Any, name: str, data_class: Any) -> None:
        make(self, name, data_class)
        self.tcp_nodelay = True  # otherwise TCP delays the second of two small messages

    subscriber.receive_callback, subscriber.add_callback, subscriber.__init__ = receive_callback, add, init


def _patch_connecting(copy: RospyCopy, network: RospyNetwork) -> None:
    manager = type(copy.topic_manager)
    acquire = manager.acquire_impl

    def acquire_impl(self: Any, kind: str, name: str, data_class: Any) -> Any:
        known = self.pubs if kind == copy.modules["rospy.impl.registration"].Registration.PUB else self.subs
        new = name not in known
        impl = acquire(self, kind, name, data_class)
        impl.ref_count += new  # an additional reference, so that the connections outlive the episode
        network.joined(copy, impl, publishes=known is self.pubs)
        return impl

    manager.acquire_impl = acquire_impl


def _patch_services(copy: RospyCopy, network: RospyNetwork) -> None:
    service, proxy = copy.tcp_services.ServiceImpl, copy.tcp_services.ServiceProxy
    make, call = service.__init__, proxy.call

    def init(self: Any, name: str, service_class: Any, handler: Any, *args: Any, **kwargs: Any) -> None:
        process = running_process()
        if process is not None and copy.rospy.core.is_initialized():
            copy.services.append(self)
            served = network.calls.served(process, name, handler)
            make(self, name, service_class, served, *args, **kwargs)
            network.wake_listening()
        else:
            make(self, name, service_class, handler, *args, **kwargs)

    def ask(self: Any, *args: Any, **kwargs: Any) -> Any:
        if running_process() is None:
            return call(self, *args, **kwargs)
        return network.calls.call(_task(), lambda: call(self, *args, **kwargs))

    service.__init__, proxy.call = init, ask


def _task() -> Task:
    task = running_task()
    if task is None:
        raise RuntimeError("only a task waits on the virtual clock")
    return task
