"""``scattermark serve``: the service and its worker on this machine."""

from __future__ import annotations

import argparse
import dataclasses
import ipaddress
import socket
from pathlib import Path
from typing import TYPE_CHECKING

from app.errors import InvalidInput, ScattermarkError

if TYPE_CHECKING:
    import uvicorn

GRACEFUL_SHUTDOWN_S = 10  # requests take tens of milliseconds; uvicorn by itself would wait for ever
GREATEST_PORT = 65535


class CannotServe(ScattermarkError):
    """The service did not start."""

    slug = "cannot-serve"


HELP = "run the service"


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the command's arguments."""
    parser.add_argument("--host", default="127.0.0.1", help="address to bind to (127.0.0.1)")
    parser.add_argument("--port", type=int, default=8000, help="port (8000); 0 takes a free one")
    parser.add_argument("--data-dir", type=Path, help="folder of photographs and database (SCATTERMARK_DATA_DIR)")
    parser.add_argument(
        "--insecure", action="store_true", help="bind to another address than this machine's own without keys"
    )


def run(arguments: argparse.Namespace) -> int:
    """Serve until told to stop."""
    _refuse_open_door(arguments.host, arguments.insecure)
    listener = _listen(arguments.host, arguments.port)
    with listener:
        server = _server(arguments)
        server.run(sockets=[listener])
        if not server.started:
            raise CannotServe("the service could not start; its log above says why")
    return 0


def _refuse_open_door(host: str, insecure: bool) -> None:
    if insecure or _is_loopback(host):
        return
    raise InvalidInput(
        f"{host} can be reached from other machines and this service has no keys yet: "
        "bind to 127.0.0.1, or say --insecure if you trust everyone who can reach it"
    )


def _is_loopback(host: str) -> bool:
    if host == "localhost":
        return True
    try:
        return ipaddress.ip_address(host).is_loopback
    except ValueError:
        return False


def _listen(host: str, port: int) -> socket.socket:
    """A listening socket, so that port 0 is known and a taken port is one clear line."""
    if not 0 <= port <= GREATEST_PORT:
        raise InvalidInput(f"--port {port}: ports go from 0 to {GREATEST_PORT}")
    try:
        family, _, _, _, address = socket.getaddrinfo(host, port, type=socket.SOCK_STREAM)[0]
        listener = socket.socket(family, socket.SOCK_STREAM)
        listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        listener.bind(address)
    except OSError as error:
        raise InvalidInput(f"cannot listen on {host} port {port}: {error.strerror}; choose another --port") from error
    return listener


def _url(listener: socket.socket) -> str:
    host, port = listener.getsockname()[:2]
    return f"http://[{host}]:{port}" if ":" in host else f"http://{host}:{port}"


def _server(arguments: argparse.Namespace) -> uvicorn.Server:
    import uvicorn

    from app.main import create_app
    from app.settings import settings_from_environment

    class Server(uvicorn.Server):
        """Says its URL on standard output, in one line, once it answers."""

        async def startup(self, sockets: list[socket.socket] | None = None) -> None:
            await super().startup(sockets)
            if self.started and sockets:
                print(f"Scattermark is ready at {_url(sockets[0])}", flush=True)

    settings = settings_from_environment()
    if arguments.data_dir is not None:
        settings = dataclasses.replace(settings, data_dir=arguments.data_dir)
    config = uvicorn.Config(
        create_app(settings),
        log_level="warning",
        lifespan="on",
        timeout_graceful_shutdown=GRACEFUL_SHUTDOWN_S,
    )
    return Server(config)
