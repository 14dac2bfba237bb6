import io
import threading

from tarl_lint.run.progress import Progress


class Terminal(io.StringIO):
    """A stream on which a test can wait for output that is flushed."""

    def __init__(self) -> None:
        super().__init__()
        self.written = threading.Event()
        self._last = ""

    def write(self, text: str) -> int:
        self._last = text
        return super().write(text)

    def flush(self) -> None:
        if "(" in self._last:
            self.written.set()


def test_a_short_run_shows_nothing():
    terminal = Terminal()
    with Progress(terminal, patience=60) as progress:
        progress.tell("Reading")
    assert terminal.getvalue() == ""


def test_a_long_run_shows_progress_and_clears_it():
    terminal = Terminal()
    with Progress(terminal, patience=0, every=0.01) as progress:
        progress.tell("Reading file 3 of 9")
        terminal.written.clear()
        assert terminal.written.wait(10)
    text = terminal.getvalue()
    assert "Reading file 3 of 9 (0 s)" in text
    assert text.endswith("\r\x1b[K")


def test_progress_ends_when_the_run_fails():
    terminal = Terminal()
    before = threading.active_count()
    try:
        with Progress(terminal, patience=60):
            raise KeyError("x")
    except KeyError:
        pass
    assert threading.active_count() == before
