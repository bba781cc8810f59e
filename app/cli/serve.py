"""``scattermark serve``: the service and its worker on this machine."""

from __future__ import annotations

import argparse
import gc
import logging
import socket
from contextlib import nullcontext
from pathlib import Path
from typing import TYPE_CHECKING

from app.cli.compile_ import compile_first
from app.cli.door import Door, add_door, guarded, host_of, open_door, refuse_open_door
from app.cli.migrate import migrate, settings_of
from app.errors import InvalidInput, ScattermarkError

if TYPE_CHECKING:
    import uvicorn

    from app.cli.graceful_server import GracefulServer
    from app.settings import Settings

GREATEST_PORT = 65535


class CannotServe(ScattermarkError):
    """The service did not start."""

    slug = "cannot-serve"


HELP = "run the service"


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the command's arguments."""
    add_door(parser)
    parser.add_argument("--port", type=int, default=8000, help="port (8000); 0 takes a free one")
    parser.add_argument("--no-worker", action="store_true", help="leave builds to `scattermark worker`, run elsewhere")
    parser.add_argument("--data-dir", type=Path, help="folder of photographs and database (SCATTERMARK_DATA_DIR)")


def run(arguments: argparse.Namespace) -> int:
    """Serve until told to stop."""
    from app.jobs.supervisor import supervised_worker

    compile_first()
    host = host_of(arguments)
    settings = guarded(settings_of(arguments.data_dir), arguments, host)
    refuse_open_door(settings, arguments, host)
    listener = _listen(host, arguments.port)
    with listener:
        start_logs(settings)
        if settings.embedded:
            migrate(settings)  # the service would do it too, and could not say in one line what is wrong
        door = open_door(settings, arguments, host)
        server = _server(settings, door)
        with nullcontext() if arguments.no_worker else supervised_worker(settings.data_dir) as supervisor:
            if supervisor is not None:
                server.beside.append(supervisor.stop)
            _run(server, listener)
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


def _url(listener: socket.socket, scheme: str) -> str:
    host, port = listener.getsockname()[:2]
    return f"{scheme}://[{host}]:{port}" if ":" in host else f"{scheme}://{host}:{port}"


def _server(settings: Settings, door: Door) -> GracefulServer:
    import uvicorn

    from app.api.locate_stream import FRAME_BYTES, MESSAGES_AHEAD
    from app.api.slow_headers import KEEP_ALIVE_S, PatientProtocol
    from app.cli.graceful_server import GracefulServer
    from app.main import create_app

    class Server(GracefulServer):
        """Says its URL on standard output, in one line, once it answers."""

        async def startup(self, sockets: list[socket.socket] | None = None) -> None:
            await super().startup(sockets)
            # What is there now stays. Full collections then walk through the rest alone: they come when that has grown
            # by a quarter, not the whole, and take no tens of milliseconds.
            gc.collect()
            gc.freeze()
            if self.started and sockets:
                print(door.greeting(_url(sockets[0], door.scheme)), flush=True)

    app = create_app(settings)
    # Logs go where all of this process's go; requests are logged by the application, which knows more of them.
    config = uvicorn.Config(
        app,
        http=PatientProtocol,
        ws_max_size=FRAME_BYTES,
        ws_max_queue=MESSAGES_AHEAD,
        ws_per_message_deflate=False,  # photographs are compressed already
        log_config=None,
        access_log=False,
        lifespan="on",
        timeout_graceful_shutdown=settings.finish_s,
        timeout_keep_alive=KEEP_ALIVE_S,
        ssl_certfile=None if door.certificate is None else door.certificate.certificate_path,
        ssl_keyfile=None if door.certificate is None else door.certificate.key_path,
    )
    return Server(config, app.state.draining, settings.drain_s)
