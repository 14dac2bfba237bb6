"""Progress of a long run, on one terminal line that appears after a delay and is cleared at the end."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import TracebackType
from typing import Final, TextIO

Tell = Callable[[str], None]

PATIENCE: Final = 1.0  # time before progress is shown (s)
EVERY: Final = 0.25
_CLEAR: Final = "\r\x1b[K"


def silent(_text: str) -> None:
    """Show nothing."""


@contextmanager
def paused(tell: Tell) -> Iterator[None]:
    """Stop the progress thread while the process forks, since a process with threads cannot be forked safely."""
    owner = getattr(tell, "__self__", None)
    if not isinstance(owner, Progress):
        yield
        return
    owner.stop()
    try:
        yield
    finally:
        owner.start()


class Progress:
    """Shows the latest text and the elapsed time."""

    def __init__(self, stream: TextIO, *, patience: float = PATIENCE, every: float = EVERY) -> None:
        self._stream = stream
        self._text = ""
        self._patience = patience
        self._every = every
        self._begun = time.monotonic()

    def __enter__(self) -> Progress:
        self.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.stop()

    def start(self) -> None:
        """Start to show progress."""
        import threading  # needed only on terminals

        self._over = threading.Event()
        self._thread = threading.Thread(target=self._paint, daemon=True)
        self._thread.start()

    def stop(self) -> None:
        """Clear the line and stop."""
        self._over.set()
        self._thread.join()

    def tell(self, text: str) -> None:
        """Set the text that is shown."""
        self._text = text

    def _paint(self) -> None:
        if self._over.wait(max(0.0, self._begun + self._patience - time.monotonic())):
            return
        while True:
            self._stream.write(f"{_CLEAR}{self._text} ({time.monotonic() - self._begun:.0f} s)")
            self._stream.flush()
            if self._over.wait(self._every):
                break
        self._stream.write(_CLEAR)
        self._stream.flush()
