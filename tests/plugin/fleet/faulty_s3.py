"""An S3 server (moto) with failures that a test requests."""

from __future__ import annotations

import io
import logging
import re
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from threading import Thread
from time import sleep
from typing import Any

Start = Callable[..., Any]
ERROR = "<?xml version='1.0'?><Error><Code>{code}</Code><Message>{code}</Message></Error>"
LATE = 1.0  # s; longer than READ_TIMEOUT
READ_TIMEOUT = 0.4  # s
CHECKED = ("HTTP_X_AMZ", "HTTP_CONTENT", "HTTP_TRANSFER", "wsgi.input")  # request headers on the body
ENTRY = re.compile(rb"<Contents>.*?</Contents>", re.DOTALL)


@dataclass
class Faults:
    """What goes wrong: `next` is asked for the fault of each request, by its method and path; "" for none.

    503: refused. lost: done, but the answer is lost. late: done, but the answer comes too late. half: half of an object
    is stored, and the answer is an error. expired: the credential is no longer valid. Paths that contain one of
    `unlisted` are not listed.
    """

    app: Any
    next: Callable[[str, str], str] = lambda method, path: ""
    unlisted: list[str] = field(default_factory=list)
    requests: list[tuple[str, str, str]] = field(default_factory=list)

    def __call__(self, environ: dict[str, Any], start: Start) -> Iterable[bytes]:
        method, path = environ["REQUEST_METHOD"], environ["PATH_INFO"]
        fault = self.next(method, path)
        self.requests.append((method, path, fault))
        if fault == "503":
            return refused(start, "503 Slow Down", "SlowDown", method)
        if fault == "expired":
            return refused(start, "400 Bad Request", "ExpiredToken", method)
        if fault == "half" and method == "PUT":
            kept = {key: value for key, value in environ.items() if not key.startswith(CHECKED)}
            body = environ["wsgi.input"].read(int(environ["CONTENT_LENGTH"]) // 2)
            short = kept | {"CONTENT_LENGTH": str(len(body)), "wsgi.input": io.BytesIO(body)}
            list(self.app(short, ignored))
            return refused(start, "503 Slow Down", "SlowDown")
        if fault == "late":
            sleep(LATE)
        if fault == "lost":
            list(self.app(environ, ignored))
            return refused(start, "503 Slow Down", "SlowDown", method)
        found: Iterable[bytes] = self.app(environ, start)
        if not self.unlisted or b"list-type" not in environ["QUERY_STRING"].encode():
            return found
        return [ENTRY.sub(self._listed, b"".join(found))]

    def _listed(self, entry: re.Match[bytes]) -> bytes:
        hidden = any(part.encode() in entry[0] for part in self.unlisted)
        return b" " * len(entry[0]) if hidden else entry[0]  # the length is in the header already


def refused(start: Start, status: str, code: str, method: str = "PUT") -> list[bytes]:
    """Refuse a request; the answer to HEAD has no body."""
    body = b"" if method == "HEAD" else ERROR.format(code=code).encode()
    start(status, [("Content-Type", "application/xml"), ("Content-Length", str(len(body)))])
    return [body]


def ignored(status: str, headers: object, problem: object = None) -> Callable[[bytes], None]:
    return lambda data: None


@contextmanager
def served() -> Iterator[tuple[Faults, str]]:
    """Serve an empty store; return its faults and its address."""
    from moto.moto_server.werkzeug_app import DomainDispatcherApplication, create_backend_app
    from werkzeug.serving import make_server

    logging.getLogger("werkzeug").setLevel(logging.ERROR)
    faults = Faults(DomainDispatcherApplication(create_backend_app))
    server = make_server("127.0.0.1", 0, faults, threaded=True)
    thread = Thread(target=server.serve_forever, daemon=True)
    thread.start()
    try:
        yield faults, f"http://127.0.0.1:{server.server_port}"
    finally:
        server.shutdown()
        thread.join()
        server.server_close()
