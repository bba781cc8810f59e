"""Where the bytes of photographs lie: objects of a folder or of an object store, by name, through obstore."""

from __future__ import annotations

import datetime as dt
import errno
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING
from urllib.parse import parse_qsl, urlsplit, urlunsplit

import obstore
from obstore.exceptions import AlreadyExistsError, BaseError
from obstore.store import LocalStore, from_url

from app.errors import InvalidInput, OutOfSpace, StorageUnavailable
from app.storage.durable_files import write_whole

if TYPE_CHECKING:
    from obstore.store import ClientConfig, ObjectStore, RetryConfig

RETRY_AFTER_S = 5
FULL = (errno.ENOSPC, errno.EDQUOT)
# A store that is there answers within a second. Its client would try for three minutes, ten times.
CLIENT: ClientConfig = {
    "connect_timeout": "5s",
    "timeout": "60s",  # 64 MiB over 10 Mbit/s
    "allow_http": True,  # taken only where somebody wrote http:// as the endpoint
}
RETRIES: RetryConfig = {"max_retries": 3, "retry_timeout": dt.timedelta(seconds=20)}
SECRETS = ("key", "secret", "token", "password", "sas", "credential")  # in names of settings


@dataclass(frozen=True)
class StoredObject:
    """What a store says of an object; ``modified_s`` is UTC, seconds since 1970, by the store's clock."""

    name: str
    size_bytes: int
    modified_s: float


class Objects:
    """Objects of an object store that several machines share: S3, Google's, Azure's."""

    def __init__(self, store: ObjectStore) -> None:
        self._store = store

    def create(self, name: str, data: bytes) -> None:
        """Put an object where none is, whole or not at all; one that is there stays.

        Raises
        ------
        StorageUnavailable, OutOfSpace
        """
        with translated():
            try:
                obstore.put(self._store, name, data, mode="create")
            except AlreadyExistsError:
                return  # named by its digest: the same bytes
            except NotImplementedError:  # conditional_put=disabled: the same bytes once more do no harm
                obstore.put(self._store, name, data, use_multipart=False)
            except FileNotFoundError as error:
                raise StorageUnavailable(
                    f"the store of photographs is not there ({_first_line(error)}); make the bucket or correct "
                    "SCATTERMARK_PHOTOGRAPHS_URL",
                    retry_after_s=RETRY_AFTER_S,
                ) from error

    def read(self, name: str) -> bytes | None:
        """An object's bytes; None when there is none.

        Raises
        ------
        StorageUnavailable
        """
        with translated():
            try:
                return bytes(obstore.get(self._store, name).bytes())
            except FileNotFoundError:
                return None

    def find(self, name: str) -> StoredObject | None:
        """What the store says of an object; None when there is none.

        Raises
        ------
        StorageUnavailable
        """
        with translated():
            try:
                meta = obstore.head(self._store, name)
            except FileNotFoundError:
                return None
        return StoredObject(meta["path"], meta["size"], meta["last_modified"].timestamp())

    def delete(self, name: str) -> None:
        """Remove an object; none is none.

        Raises
        ------
        StorageUnavailable
        """
        with translated():
            try:
                obstore.delete(self._store, name)
            except FileNotFoundError:
                return

    def all(self) -> Iterator[StoredObject]:
        """Every object, in no order.

        Raises
        ------
        StorageUnavailable
        """
        with translated():
            for batch in obstore.list(self._store):
                for meta in batch:
                    yield StoredObject(meta["path"], meta["size"], meta["last_modified"].timestamp())

    def check(self) -> None:
        """Ask for an answer.

        Raises
        ------
        StorageUnavailable
        """
        with translated():
            next(iter(obstore.list(self._store, chunk_size=1)), None)


class FolderObjects(Objects):
    """Objects of a folder. obstore writes without fsync, so a photograph that was confirmed could be lost: not here."""

    def __init__(self, folder: Path, aside: Path) -> None:
        super().__init__(LocalStore(folder))
        self._folder = folder
        self._aside = aside

    def create(self, name: str, data: bytes) -> None:
        """Put an object where none is, on the disk when this returns; one that is there stays."""
        with translated():
            place = self._folder / name
            if not place.exists():
                write_whole(place, data, self._aside)

    def check(self) -> None:
        """See whether the folder can be written to."""
        with translated(), tempfile.TemporaryFile(dir=self._aside, buffering=0) as file:
            file.write(b"?")


def folder_of(url: str) -> Path | None:
    """The folder that an address means; None when it is of an object store."""
    parts = urlsplit(url)
    if parts.scheme == "file":
        return Path(parts.path)
    return None if "://" in url else Path(url)


def remote_objects(url: str) -> Objects:
    """The objects below a URL such as ``s3://bucket/prefix?region=eu-central-1``.

    Raises
    ------
    InvalidInput
        For a URL that names no store, and one that holds a secret.
    """
    parts = urlsplit(url)
    settings = dict(parse_qsl(parts.query))
    secrets = [name for name in settings if any(word in name.lower() for word in SECRETS)]
    if secrets:
        raise InvalidInput(
            f"SCATTERMARK_PHOTOGRAPHS_URL holds {', '.join(secrets)}, which a log might show; "
            "give credentials in the environment (AWS_ACCESS_KEY_ID, AWS_SECRET_ACCESS_KEY ...)"
        )
    address = urlunsplit((parts.scheme, parts.netloc, parts.path, "", ""))
    try:
        return Objects(from_url(address, config=settings, client_options=CLIENT, retry_config=RETRIES))  # type: ignore[call-overload]
    except (BaseError, ValueError) as error:
        raise InvalidInput(f"SCATTERMARK_PHOTOGRAPHS_URL={url!r} names no store: {_first_line(error)}") from error


@contextmanager
def translated() -> Iterator[None]:
    """Errors of the disk and of the store's client as errors that say what to do."""
    try:
        yield
    except OSError as error:
        if error.errno in FULL:
            raise OutOfSpace(
                "the disk of the photographs is full; make room on it (`scattermark purge` removes what nothing "
                "refers to), then send the request again"
            ) from error
        raise _unavailable(error) from error
    except BaseError as error:
        raise _unavailable(error) from error


def _unavailable(error: Exception) -> StorageUnavailable:
    return StorageUnavailable(
        f"the store of photographs gave no answer ({_first_line(error)}); send the request again, and look at "
        "/readyz, SCATTERMARK_PHOTOGRAPHS_URL and its credentials if it stays so",
        retry_after_s=RETRY_AFTER_S,
    )


def _first_line(error: Exception) -> str:
    """Of a message that goes on for pages; what a server wrote into its answer stays out."""
    return (str(error).splitlines() or [type(error).__name__])[0].split(": <?xml")[0]
