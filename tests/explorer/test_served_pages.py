"""A page that grows is served to this machine alone, to whoever knows its token, and writes nothing."""

from __future__ import annotations

import http.client
import threading
from urllib.parse import urlsplit

import numpy as np
import pytest
from explorer_pages import blocks

from contwalk.errors import ContwalkError
from contwalk.explorer.watching import Watched, server_of
from contwalk.storage import open_database
from contwalk.workflow.run_file.reading import read_run_file
from contwalk.workflow.runner import run

STUDY = """\
contwalk: 1
system: {equations: "x' = r + x^2; y' = x - y; r = -1"}
start: {state: {x: -1.0, y: -1.0}}
continue: {parameter: r, range: [-1, 1], max_points: COUNT}
output: fold.h5
"""


def computed(folder, count):
    (folder / "fold.yaml").write_text(STUDY.replace("COUNT", str(count)), encoding="utf-8")
    return run(
        read_run_file(folder / "fold.yaml", (), str(folder / "fold.h5")), force=True, figures=False
    ).path


class Client:
    """Asks a server that runs in a thread."""

    def __init__(self, watched):
        self.server, address = server_of(watched)
        self.parts = urlsplit(address)
        self.thread = threading.Thread(target=self.server.serve_forever, kwargs={"poll_interval": 0.01})
        self.thread.start()

    def ask(self, path="", method="GET", **headers):
        connection = http.client.HTTPConnection(self.parts.hostname, self.parts.port, timeout=60)
        connection.request(method, path if path.startswith("/") else self.parts.path + path, headers=headers)
        answer = connection.getresponse()
        found = answer.status, answer.read().decode("utf-8"), dict(answer.getheaders())
        connection.close()
        return found

    def close(self):
        self.server.shutdown()
        self.thread.join()
        self.server.server_close()


@pytest.fixture
def serve():
    clients = []

    def started(path):
        clients.append(Client(Watched(path)))
        return clients[-1]

    yield started
    for client in clients:
        client.close()


def test_the_page_grows_with_its_database(serve, tmp_path):
    client = serve(computed(tmp_path, 6))
    status, page, headers = client.ask()
    assert (status, headers["Cache-Control"]) == (200, "no-store")
    state = client.ask("state")[1]
    first = blocks(page)["head"][0]
    assert first["watched"] == state
    assert "connect-src 'self'" in page or "connect-src &#x27;self&#x27;" in page
    computed(tmp_path, 12)
    assert client.ask("state")[1] != state
    second = blocks(client.ask()[1])["head"][0]
    assert second["branches"][0]["count"] > first["branches"][0]["count"]


def test_nobody_else_gets_it(serve, tmp_path):
    client = serve(computed(tmp_path, 6))
    assert client.server.server_address[0] == "127.0.0.1"
    assert client.ask(Host="evil.example")[0] == 421
    assert client.ask(Host=f"localhost:{client.parts.port}")[0] == 200
    assert client.ask("/")[0] == client.ask("/another/")[0] == client.ask("../fold.h5")[0] == 404
    assert {client.ask(method=method)[0] for method in ("POST", "PUT", "DELETE")} == {501}


def test_what_is_written_meanwhile_is_the_same(serve, tmp_path):
    def rows():
        with open_database(tmp_path / "fold.h5") as database:
            return [branch.points for branch in database.branches()]

    computed(tmp_path, 30)
    alone = rows()
    client, ended = serve(tmp_path / "fold.h5"), threading.Event()

    def look():
        while not ended.is_set():
            client.ask()

    looking = threading.Thread(target=look)
    looking.start()
    computed(tmp_path, 30)
    ended.set()
    looking.join()
    for before, after in zip(alone, rows(), strict=True):
        for name in set(before.dtype.names) - {"seconds"}:
            assert np.array_equal(before[name], after[name], equal_nan=True), name


def test_a_database_that_is_gone_is_told(serve, tmp_path):
    client = serve(computed(tmp_path, 6))
    (tmp_path / "fold.h5").unlink()
    status, text, _ = client.ask()
    assert status == 503
    assert "fold.h5" in text
    assert client.ask("state")[1] == "gone"


def test_a_port_that_is_taken_is_told(serve, tmp_path):
    client = serve(computed(tmp_path, 6))
    with pytest.raises(ContwalkError, match="cannot be used"):
        server_of(Watched(tmp_path / "fold.h5"), client.parts.port)
