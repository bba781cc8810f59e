"""An object store for tests: a server on this machine that speaks S3."""

from __future__ import annotations

import os
import urllib.request
from collections.abc import Iterator
from contextlib import contextmanager
from itertools import count

from moto.server import ThreadedMotoServer

# Worker processes get the environment of the first one that was started: it is set before any is.
os.environ.setdefault("AWS_ACCESS_KEY_ID", "of-tests")
os.environ.setdefault("AWS_SECRET_ACCESS_KEY", "of-tests")


class S3Server:
    """Buckets of one server."""

    def __init__(self, endpoint: str) -> None:
        self.endpoint = endpoint
        self._numbers = count()

    def new_url(self) -> str:
        """Where a bucket's photographs shall lie; the bucket is empty."""
        bucket = f"bucket-{next(self._numbers)}"
        urllib.request.urlopen(urllib.request.Request(f"{self.endpoint}/{bucket}", method="PUT")).close()
        return self.url_of(bucket)

    def url_of(self, bucket: str) -> str:
        return f"s3://{bucket}/photographs?region=us-east-1&endpoint={self.endpoint}"


@contextmanager
def s3_server() -> Iterator[S3Server]:
    server = ThreadedMotoServer(ip_address="127.0.0.1", port=0, verbose=False)
    server.start()
    try:
        host, port = server.get_host_and_port()
        yield S3Server(f"http://{host}:{port}")
    finally:
        server.stop()
