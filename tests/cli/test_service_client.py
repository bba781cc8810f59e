"""The client speaks HTTP with a real server and turns its problems into errors."""

from __future__ import annotations

import json
import threading
from collections.abc import Iterator
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import Any

import pytest

from app.cli.service_client import ServiceClient, ServiceProblem


class Echo(BaseHTTPRequestHandler):
    """Answers with what it was asked, or with a problem."""

    protocol_version = "HTTP/1.1"

    def answer(self) -> None:
        length = int(self.headers.get("Content-Length") or 0)
        data = self.rfile.read(length)
        if self.path.startswith("/problem"):
            self.send(422, {"type": "https://x/problems/not-located", "detail": "seen nothing", "reason": "no-targets"})
        elif self.path.startswith("/broken"):
            self.send_bytes(500, b"<html>oops</html>")
        else:
            kind = self.headers.get("Content-Type")
            self.send(200, {"method": self.command, "path": self.path, "data": data.decode(), "kind": kind})

    def send(self, status: int, record: dict[str, Any]) -> None:
        self.send_bytes(status, json.dumps(record).encode())

    def send_bytes(self, status: int, body: bytes) -> None:
        self.send_response(status)
        self.send_header("Content-Length", str(len(body)))
        self.end_headers()
        self.wfile.write(body)

    do_GET = do_POST = do_PUT = answer

    def log_message(self, *_: object) -> None:
        """Quiet."""


@pytest.fixture(scope="module")
def client() -> Iterator[ServiceClient]:
    with ThreadingHTTPServer(("127.0.0.1", 0), Echo) as server:
        server.daemon_threads = True
        thread = threading.Thread(target=server.serve_forever)
        thread.start()
        client = ServiceClient(f"http://127.0.0.1:{server.server_port}")
        yield client
        client.close()
        server.shutdown()
        thread.join()


def test_calls_carry_what_they_are_given(client: ServiceClient) -> None:
    assert client.get("sites", "a b/c", format="json")["path"] == "/sites/a%20b%2Fc?format=json"
    posted = client.post("sites", body={"name": "hall"})
    assert (posted["method"], json.loads(posted["data"])) == ("POST", {"name": "hall"})
    put = client.put("sites", "1", "control-points", data=b"name,code", kind="text/csv")
    assert (put["method"], put["data"], put["kind"]) == ("PUT", "name,code", "text/csv")
    assert client.send_photo("locate", data=b"jpeg", site_id="1")["path"] == "/locate?site_id=1"


def test_a_problem_is_an_error_with_its_members(client: ServiceClient) -> None:
    with pytest.raises(ServiceProblem, match="seen nothing") as caught:
        client.get("problem")
    assert caught.value.kind == "not-located"
    assert caught.value.fields["reason"] == "no-targets"
    assert caught.value.fields["status"] == 422


def test_an_answer_that_is_no_json_is_an_error(client: ServiceClient) -> None:
    with pytest.raises(ServiceProblem, match="status 500"):
        client.get("broken")
    assert client.get("still")["path"] == "/still"


def test_no_service_is_an_error() -> None:
    with ThreadingHTTPServer(("127.0.0.1", 0), Echo) as server:
        port = server.server_port
    with pytest.raises(ServiceProblem, match="gave no answer"):
        ServiceClient(f"http://127.0.0.1:{port}").get("healthz")
