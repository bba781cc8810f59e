"""A service that asks for keys, and its clients."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import httpx

from app.settings import Settings
from tests.api.serving import ANSWER_S, Served, serve

ADMIN_SECRET = "0123456789abcdef-of-the-operator"


@dataclass
class Guarded(Served):
    """A running service whose ``client`` shows the administrator's key."""

    def new_key(self, *scopes: str, **body: Any) -> dict[str, Any]:
        answer = self.client.post("/keys", json={"name": "test", "scopes": scopes, **body})
        assert answer.status_code == 201, answer.text
        made: dict[str, Any] = answer.json()
        return made

    def anonymous(self) -> httpx.Client:
        """A client without a key."""
        return httpx.Client(base_url=self.client.base_url, timeout=ANSWER_S)

    def holder(self, *scopes: str, **body: Any) -> httpx.Client:
        """A client that shows a new key."""
        return self.with_secret(self.new_key(*scopes, **body)["secret"])

    def with_secret(self, secret: str) -> httpx.Client:
        headers = {"Authorization": f"Bearer {secret}"}
        return httpx.Client(base_url=self.client.base_url, headers=headers, timeout=ANSWER_S)


@contextmanager
def serve_guarded(folder: Path, **changes: Any) -> Iterator[Guarded]:
    """Run a service that asks for keys until the block ends."""
    settings = Settings(
        data_dir=folder, locate_workers=1, require_keys=True, bootstrap_key=ADMIN_SECRET, key_rate_per_s=100_000.0
    )
    with serve(replace(settings, **changes), worker=False) as running:
        running.client.headers["Authorization"] = f"Bearer {ADMIN_SECRET}"
        yield Guarded(**vars(running))
