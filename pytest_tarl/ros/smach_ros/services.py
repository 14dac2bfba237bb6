"""A state that calls a service."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any

from pytest_tarl.ros.rospy.exceptions import ROSException, ServiceException
from pytest_tarl.ros.rospy.log import logerr
from pytest_tarl.ros.rospy.node import is_shutdown
from pytest_tarl.ros.rospy.services import ServiceProxy, wait_for_service
from pytest_tarl.ros.smach.state import State
from pytest_tarl.ros.smach_ros import slots


class ServiceState(State):
    """Calls a service; its outcomes are "succeeded", "aborted", "preempted" and those of `response_cb`."""

    def __init__(
        self,
        service_name: str,
        service_spec: Any,
        request: Any = None,
        request_key: str | None = None,
        request_slots: Sequence[str] = (),
        request_cb: Callable[..., Any] | None = None,
        request_cb_args: Sequence[Any] = (),
        request_cb_kwargs: Mapping[str, Any] | None = None,
        response_key: str | None = None,
        response_slots: Sequence[str] = (),
        response_cb: Callable[..., Any] | None = None,
        response_cb_args: Sequence[Any] = (),
        response_cb_kwargs: Mapping[str, Any] | None = None,
        input_keys: Iterable[str] = (),
        output_keys: Iterable[str] = (),
        outcomes: Iterable[str] = (),
    ) -> None:
        super().__init__(["succeeded", "aborted", "preempted", *outcomes], input_keys, output_keys)
        self._name, self._proxy = service_name, ServiceProxy(service_name, service_spec)
        # an older form of the call passes the callback as `request`
        if callable(request) and request_cb is None:
            request, request_cb = None, request
        self._request = service_spec._request_class() if request is None else request
        self._request_key, self._request_slots = request_key, list(request_slots)
        self._request_cb = (request_cb, tuple(request_cb_args), dict(request_cb_kwargs or {}))
        self._response_key, self._response_slots = response_key, list(response_slots)
        self._response_cb = (response_cb, tuple(response_cb_args), dict(response_cb_kwargs or {}))
        callbacks = [one for one in (request_cb, response_cb) if one is not None]
        read = [*self._request_slots, *([request_key] if request_key is not None else [])]
        written = [*self._response_slots, *([response_key] if response_key is not None else [])]
        slots.declare(self, callbacks, read, written)

    def execute(self, ud: Any) -> str:
        """Wait for the service, call it, and return the outcome."""
        while not is_shutdown():
            if self.preempt_requested():
                self.service_preempt()
                return "preempted"
            try:
                wait_for_service(self._name, 1.0)
                break
            except ROSException as error:
                if getattr(error, "tarl_shutdown", False):
                    raise
        request = slots.build(
            self, ud, self._request, self._request_key, self._request_slots, self._request_cb
        )
        try:
            response = self._proxy(request)
        except ServiceException as error:
            logerr(f"Service {self._name} failed: {error}")
            return "aborted"
        slots.store(ud, response, self._response_key, self._response_slots)
        function, args, kwargs = self._response_cb
        if function is not None:
            chosen = function(slots.view(self, ud, function), response, *args, **kwargs)
            if chosen is not None and chosen in self.get_registered_outcomes():
                return str(chosen)
        return "succeeded"
