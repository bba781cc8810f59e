"""``scattermark serve``: the service and its worker on this machine."""

from __future__ import annotations

import argparse
import ipaddress
import logging
import socket
from contextlib import nullcontext
from pathlib import Path
from typing import TYPE_CHECKING

from app.cli.migrate import migrate, settings_of
from app.errors import InvalidInput, ScattermarkError

if TYPE_CHECKING:
    import uvicorn

    from app.settings import Settings

GREATEST_PORT = 65535


class CannotServe(ScattermarkError):
    """The service did not start."""

    slug = "cannot-serve"


HELP = "run the service"


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the command's arguments."""
    parser.add_argument("--host", default="127.0.0.1", help="address to bind to (127.0.0.1)")
    parser.add_argument("--port", type=int, default=8000, help="port (8000); 0 takes a free one")
    parser.add_argument("--no-worker", action="store_true", help="leave builds to `scattermark worker`, run elsewhere")
    parser.add_argument("--data-dir", type=Path, help="folder of photographs and database (SCATTERMARK_DATA_DIR)")
    parser.add_argument(
        "--insecure", action="store_true", help="bind to another address than this machine's own without keys"
    )


def run(arguments: argparse.Namespace) -> int:
    """Serve until told to stop."""
    from app.jobs.supervisor import supervised_worker

    _refuse_open_door(arguments.host, arguments.insecure)
    listener = _listen(arguments.host, arguments.port)
    with listener:
        settings = settings_of(arguments.data_dir)
        start_logs(settings)
        if settings.embedded:
            migrate(settings)  # the service would do it too, and could not say in one line what is wrong
        with nullcontext() if arguments.no_worker else supervised_worker(settings.data_dir):
            _run(_server(settings), listener)
    return 0


def start_logs(settings: Settings) -> None:
    """Let this process log as the settings say."""
    from app.logs import LogOptions, configure_logs

    configure_logs(LogOptions(settings.log_format, settings.log_level))


def _run(server: uvicorn.Server, listener: socket.socket) -> None:
    logging.getLogger("uvicorn.error").addFilter(_without_traceback)
    try:
        server.run(sockets=[listener])
    except SystemExit as end:
        raise CannotServe("the service could not start; the line above says why") from end


def _without_traceback(record: logging.LogRecord) -> bool:
    """Cut a traceback, which uvicorn logs as one message, down to the line that says what happened."""
    message = record.getMessage()
    if message.startswith("Traceback"):
        record.msg, record.args = message.strip().splitlines()[-1], ()
    return True


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
        listener = socket.create_server(address[:2], family=family)
    except OSError as error:
        raise InvalidInput(f"cannot listen on {host} port {port}: {error.strerror}; choose another --port") from error
    # Connections inherit it. asyncio would set it, but not on connections of a socket that it was given: head and body
    # of an answer are two writes, and the second would wait for the client's delayed acknowledgement, 40 ms on Linux.
    listener.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
    return listener


def _url(listener: socket.socket) -> str:
    host, port = listener.getsockname()[:2]
    return f"http://[{host}]:{port}" if ":" in host else f"http://{host}:{port}"


def _server(settings: Settings) -> uvicorn.Server:
    import uvicorn

    from app.api.slow_headers import PatientProtocol
    from app.cli.graceful_server import GracefulServer
    from app.main import create_app

    class Server(GracefulServer):
        """Says its URL on standard output, in one line, once it answers."""

        async def startup(self, sockets: list[socket.socket] | None = None) -> None:
            await super().startup(sockets)
            if self.started and sockets:
                print(f"Scattermark is ready at {_url(sockets[0])}", flush=True)

    app = create_app(settings)
    # Logs go where all of this process's go; requests are logged by the application, which knows more of them.
    config = uvicorn.Config(app, http=PatientProtocol, log_config=None, access_log=False, lifespan="on")
    return Server(config, app.state.draining, settings.drain_s)
