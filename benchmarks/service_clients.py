"""Clients that cost little: requests made once, sent over raw sockets that stay open, one thread per client.

They run in a process of their own (``python -m benchmarks.service_clients``), for a client in the server's process
would take turns with it; on a machine with few cores they take some of its time all the same, and say how much.
"""

from __future__ import annotations

import argparse
import json
import socket
import subprocess
import sys
import threading
import time
from collections import Counter
from dataclasses import asdict, dataclass, field
from pathlib import Path
from urllib.parse import urlencode

BOUNDARY = "scattermark-benchmark"
HEAD_BYTES = 65536
OK, FULL = 200, 503
FULL_PAUSE_S = 0.02  # of a client that was told to come back: not the second it was told, so that the load stays


@dataclass(frozen=True)
class Load:
    """What clients send.

    Attributes
    ----------
    port : int
    site_id, photo : str
        The photograph as a path.
    form : bool
        As a form; else as raw body.
    clients : int
        Each sends the next request when it has its answer.
    requests : int
        Of all clients together.
    """

    port: int
    site_id: str
    photo: str
    form: bool
    clients: int
    requests: int


@dataclass
class Outcome:
    """What came of it.

    Attributes
    ----------
    latencies_s : list of float
        Of the requests that were located.
    statuses : dict
        How many answers of each status.
    duration_s, client_cpu_s, service_cpu_s : float
        By the clock, and processor time: of the clients, and of the process that answers them (not of its workers).
    """

    latencies_s: list[float] = field(default_factory=list)
    statuses: dict[str, int] = field(default_factory=dict)
    duration_s: float = 0.0
    client_cpu_s: float = 0.0
    service_cpu_s: float = 0.0

    @property
    def per_s(self) -> float:
        """Located snapshots a second."""
        return len(self.latencies_s) / self.duration_s


class Client:
    """One connection that asks the same thing again and again."""

    def __init__(self, load: Load) -> None:
        self._request = request_bytes(load)
        self._socket = socket.create_connection(("127.0.0.1", load.port))
        self._socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)

    def ask(self) -> int:
        """Send the request; the answer's status."""
        self._socket.sendall(self._request)
        data = self._socket.recv(HEAD_BYTES)
        while b"\r\n\r\n" not in data:
            data += self._received()
        head, _, body = data.partition(b"\r\n\r\n")
        missing = _length(head) - len(body)
        while missing > 0:
            missing -= len(self._received())
        return int(head.split(b" ", 2)[1])

    def close(self) -> None:
        """Hang up."""
        self._socket.close()

    def _received(self) -> bytes:
        data = self._socket.recv(HEAD_BYTES)
        if not data:
            raise ConnectionError("the service hung up")
        return data


def request_bytes(load: Load) -> bytes:
    """The whole request."""
    photo = Path(load.photo).read_bytes()
    if not load.form:
        return _post(f"/locate?{urlencode({'site_id': load.site_id})}", "image/jpeg", photo)
    parts = [
        f'--{BOUNDARY}\r\nContent-Disposition: form-data; name="site_id"\r\n\r\n{load.site_id}\r\n',
        f'--{BOUNDARY}\r\nContent-Disposition: form-data; name="image"; filename="a.jpg"\r\n'
        "Content-Type: image/jpeg\r\n\r\n",
    ]
    body = "".join(parts).encode() + photo + f"\r\n--{BOUNDARY}--\r\n".encode()
    return _post("/locate", f"multipart/form-data; boundary={BOUNDARY}", body)


def _post(target: str, kind: str, body: bytes) -> bytes:
    head = f"POST {target} HTTP/1.1\r\nHost: 127.0.0.1\r\nContent-Type: {kind}\r\nContent-Length: {len(body)}\r\n\r\n"
    return head.encode() + body


def _length(head: bytes) -> int:
    lines = head.lower().split(b"\r\n")
    return int(next(line.split(b":")[1] for line in lines if line.startswith(b"content-length:")))


def drive(load: Load) -> Outcome:
    """Send all requests from this process."""
    outcome, statuses, lock = Outcome(), Counter[str](), threading.Lock()
    left = iter(range(load.requests))

    def work() -> None:
        client = Client(load)
        while True:
            with lock:
                if next(left, None) is None:
                    break
            began_s = time.perf_counter()
            status = client.ask()
            latency_s = time.perf_counter() - began_s
            with lock:
                statuses[str(status)] += 1
                if status == OK:
                    outcome.latencies_s.append(latency_s)
            if status == FULL:
                time.sleep(FULL_PAUSE_S)
        client.close()

    began_s, began_cpu_s = time.perf_counter(), time.process_time()
    threads = [threading.Thread(target=work) for _ in range(load.clients)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    outcome.duration_s, outcome.client_cpu_s = time.perf_counter() - began_s, time.process_time() - began_cpu_s
    outcome.statuses = dict(statuses)
    return outcome


def drive_apart(load: Load) -> Outcome:
    """Send all requests from a process of their own."""
    command = [sys.executable, "-m", "benchmarks.service_clients", json.dumps(asdict(load))]
    done = subprocess.run(command, stdout=subprocess.PIPE, check=True, text=True)
    return Outcome(**json.loads(done.stdout))


def main() -> None:
    """The process of ``drive_apart``."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("load", help="JSON of a Load")
    print(json.dumps(asdict(drive(Load(**json.loads(parser.parse_args().load))))))


if __name__ == "__main__":
    main()
