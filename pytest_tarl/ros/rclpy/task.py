"""Futures, and coroutines run by an executor."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Generator
from typing import Any


class Future:
    """A result that becomes available later."""

    def __init__(self, *, executor: Any = None) -> None:
        self._done = False
        self._cancelled = False
        self._result: Any = None
        self._exception: BaseException | None = None
        self._callbacks: list[Callable[[Future], Any]] = []
        self._watchers: list[Callable[[], Any]] = []
        self._executor = executor

    def __await__(self) -> Generator[Future, None, Any]:
        while self.pending():
            yield self
        return self.result()

    def done(self) -> bool:
        """Return whether there is a result or an exception; False if the future was cancelled."""
        return self._done

    def pending(self) -> bool:
        """Return whether the future is neither done nor cancelled."""
        return not (self._done or self._cancelled)

    def cancelled(self) -> bool:
        """Return whether the future was cancelled."""
        return self._cancelled

    def cancel(self) -> None:
        """Cancel the future."""
        if self.pending():
            self._cancelled = True
            self._finish()

    def result(self) -> Any:
        """Return the result, or None if there is none yet. Raise the exception if there is one."""
        if self._exception is not None:
            raise self._exception
        return self._result

    def exception(self) -> BaseException | None:
        """Return the exception."""
        return self._exception

    def set_result(self, result: Any) -> None:
        """Set the result."""
        self._result = result
        self._done, self._cancelled = True, False
        self._finish()

    def set_exception(self, exception: BaseException) -> None:
        """Set the exception."""
        self._exception = exception
        self._done, self._cancelled = True, False
        self._finish()

    def add_done_callback(self, callback: Callable[[Future], Any]) -> None:
        """Register a function to call with this future when it is done. The executor, if any, makes the call."""
        if self.pending():
            self._callbacks.append(callback)
        elif self._executor is not None:
            self._executor.create_task(callback, self)
        else:
            callback(self)

    def watch(self, watcher: Callable[[], Any]) -> None:
        """Register an internal callback that is called as soon as the future is done."""
        if self.pending():
            self._watchers.append(watcher)
        else:
            watcher()

    def belongs_to(self, executor: Any) -> None:
        """Set the executor that runs the done callbacks."""
        self._executor = executor

    def remove_done_callback(self, callback: Callable[[Future], Any]) -> bool:
        """Remove a done callback; return whether it was registered."""
        if callback not in self._callbacks:
            return False
        self._callbacks.remove(callback)
        return True

    def _finish(self) -> None:
        watchers, self._watchers = self._watchers, []
        for watcher in watchers:
            watcher()
        callbacks, self._callbacks = self._callbacks, []
        for callback in callbacks:
            if self._executor is not None:
                self._executor.create_task(callback, self)
            else:
                callback(self)


class Task(Future):
    """A function or coroutine in the queue of an executor."""

    def __init__(
        self, handler: Any, args: tuple[Any, ...] = (), kwargs: Any = None, executor: Any = None
    ) -> None:
        super().__init__(executor=executor)
        self._handler = handler
        self._args, self._kwargs = args, kwargs or {}
        self._coroutine: Any = handler if inspect.iscoroutine(handler) else None
        self._blocked = False
        self._executing = False
        self.callback_group: Any = None

    def is_ready(self) -> bool:
        """Return whether the task can continue."""
        return self.pending() and not (self._blocked or self._executing)

    def executing(self) -> bool:
        """Return whether the task is running now."""
        return self._executing

    def cancel(self) -> None:
        """Cancel the task; close its coroutine if it has started."""
        if self._coroutine is not None and self.pending():
            self._coroutine.close()
        super().cancel()

    def run(self) -> None:
        """Continue to the end, or to the next future that is not done. The executor's spin re-raises exceptions."""
        self._executing = True
        try:
            self._advance()
        except Exception as error:
            self.set_exception(error)
            raise
        finally:
            self._executing = False

    def _advance(self) -> None:
        if self._coroutine is None:
            outcome = self._handler(*self._args, **self._kwargs)
            if not inspect.iscoroutine(outcome):
                self.set_result(outcome)
                return
            self._coroutine = outcome
        try:
            awaited = self._coroutine.send(None)
        except StopIteration as end:
            self.set_result(end.value)
            return
        self._blocked = True
        if isinstance(awaited, Future):
            awaited.watch(self._unblock)
        else:
            self._unblock()

    def _unblock(self) -> None:
        self._blocked = False
        if self._executor is not None:
            self._executor.wake()


__all__ = ["Future", "Task"]
