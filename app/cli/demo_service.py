"""The real service in a process of its own, on a free port, with its data in a folder of the caller's."""

from __future__ import annotations

import os
import subprocess
import sys
import threading
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path

from app.errors import ScattermarkError

START_TIMEOUT_S = 180.0  # imports, tables and warm workers take seconds; a loaded machine may need far longer
STOP_TIMEOUT_S = 20.0  # longer than the service's own limit for a graceful stop
LOG_NAME = "service.log"
LOG_LINES_SHOWN = 12


class ServiceFailed(ScattermarkError):
    """The service did not start or died."""

    slug = "service-failed"


@contextmanager
def running_service(data_dir: Path) -> Iterator[str]:
    """Run ``scattermark serve`` until the block ends.

    Yields
    ------
    str
        Its URL.

    Raises
    ------
    ServiceFailed
        With the last lines of its log when it does not start.
    """
    environment = without_settings(os.environ)
    command = [sys.executable, "-m", "app.cli", "serve", "--port", "0", "--data-dir", str(data_dir)]
    log_path = data_dir / LOG_NAME
    with (
        log_path.open("w") as log,
        subprocess.Popen(command, stdout=subprocess.PIPE, stderr=log, text=True, env=environment) as service,
    ):
        try:
            yield _url(service, log_path)
        finally:
            _stop(service)


def without_settings(environment: Mapping[str, str]) -> dict[str, str]:
    """An environment without this shell's settings: the demo shall meet neither another database nor other limits."""
    return {name: value for name, value in environment.items() if not name.startswith("SCATTERMARK_")}


def _url(service: subprocess.Popen[str], log_path: Path) -> str:
    """The URL in the line that the service prints once it is ready."""
    assert service.stdout is not None
    impatience = threading.Timer(START_TIMEOUT_S, service.kill)
    impatience.start()
    line = service.stdout.readline()
    impatience.cancel()
    words = [word for word in line.split() if word.startswith("http")]
    if words:
        return words[0]
    last = "\n".join(log_path.read_text(errors="replace").splitlines()[-LOG_LINES_SHOWN:])
    raise ServiceFailed(f"the service did not start; the end of its log:\n{last}")


def _stop(service: subprocess.Popen[str]) -> None:
    service.terminate()
    try:
        service.wait(STOP_TIMEOUT_S)
    except subprocess.TimeoutExpired:
        service.kill()
