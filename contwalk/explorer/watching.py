"""The page of a database that grows, served to this machine alone, and to whoever knows its token."""

from __future__ import annotations

import secrets
import threading
from collections.abc import Callable
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import Any

from contwalk.errors import ContwalkError
from contwalk.explorer.exploring import explored
from contwalk.storage import open_database

LOOPBACK = "127.0.0.1"


class Watched:
    """The page of a database as it is now, made anew where the file has changed.

    While a branch is being computed the page has no motions: these would cost more than the run.

    Parameters
    ----------
    path : Path
    trust : bool
    """

    def __init__(self, path: Path, trust: bool = False) -> None:
        self.path, self.trust = path, trust
        self._lock = threading.Lock()
        self._made: tuple[str, bytes] = ("", b"")

    def state(self) -> str:
        """What changes with the file."""
        try:
            found = self.path.stat()
        except OSError:
            return "gone"
        return f"{found.st_mtime_ns:x}-{found.st_size:x}"

    def page(self) -> tuple[str, bytes]:
        """The state, and the page."""
        with self._lock:
            state = self.state()
            if state != self._made[0]:
                with open_database(self.path, self.trust) as database:
                    moving = all(branch.complete for branch in database.branches())
                    page = explored(database, self.trust, moving=moving, watched=state).page
                self._made = state, page.encode("utf-8")
            return self._made


def server_of(watched: Watched, port: int = 0) -> tuple[ThreadingHTTPServer, str]:
    """A server on the loopback address, which answers once it runs; and the address of the page.

    Raises
    ------
    ContwalkError
        If the port is taken.
    """
    token = secrets.token_urlsafe(18)
    handler = type("Handler", (_Handler,), {"watched": watched, "token": token})
    try:
        server = ThreadingHTTPServer((LOOPBACK, port), handler)
    except OSError as error:
        raise ContwalkError(
            f"Port {port} of {LOOPBACK} cannot be used: {error.strerror}.", "Give another one, or none."
        ) from error
    server.daemon_threads = True
    return server, f"http://{LOOPBACK}:{server.server_port}/{token}/"


class _Handler(BaseHTTPRequestHandler):
    """Answers two questions: what the page is, and whether it has changed."""

    watched: Watched
    token: str
    server_version, sys_version = "contwalk", ""

    def do_GET(self) -> None:
        """The page, or the state of the database."""
        port = self.server.server_port  # type: ignore[attr-defined]
        if self.headers.get("Host") not in (f"{LOOPBACK}:{port}", f"localhost:{port}"):
            self._answer(HTTPStatus.MISDIRECTED_REQUEST, b"This server answers to its own address alone.\n")
            return
        address = self.path.partition("?")[0]
        answers: dict[str, Callable[[], tuple[str, bytes]]] = {
            f"/{self.token}/": lambda: ("text/html", self.watched.page()[1]),
            f"/{self.token}/state": lambda: ("text/plain", self.watched.state().encode("ascii")),
        }
        known = next((made for name, made in answers.items() if secrets.compare_digest(name, address)), None)
        if known is None:
            self._answer(HTTPStatus.NOT_FOUND, b"There is nothing at this address.\n")
            return
        try:
            kind, text = known()
        except ContwalkError as error:
            self._answer(HTTPStatus.SERVICE_UNAVAILABLE, f"{error}\n".encode())
            return
        self._answer(HTTPStatus.OK, text, kind)

    def _answer(self, status: HTTPStatus, text: bytes, kind: str = "text/plain") -> None:
        self.send_response(status)
        for name, value in {
            "Content-Type": f"{kind}; charset=utf-8",
            "Content-Length": str(len(text)),
            "Cache-Control": "no-store",
            "Referrer-Policy": "no-referrer",
            "X-Content-Type-Options": "nosniff",
            "X-Frame-Options": "DENY",
            "Cross-Origin-Resource-Policy": "same-origin",
        }.items():
            self.send_header(name, value)
        self.end_headers()
        self.wfile.write(text)

    def log_message(self, format: str, *args: Any) -> None:
        """Nothing is told of requests."""
