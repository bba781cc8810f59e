"""The same promises from a folder and from an object store."""

from __future__ import annotations

import hashlib
import os
import time
from collections.abc import Callable
from pathlib import Path

import pytest

from app.errors import InvalidInput, NotFound, OutOfSpace, PhotoTooLarge, StorageUnavailable
from app.storage.photo_store import ABANDONED_AFTER_S, PhotoStore, open_photo_store, place_of
from tests.object_stores import S3Server

LIMIT = 100
MISSING = "0" * 64


@pytest.fixture(params=["folder", "s3"])
def url(request: pytest.FixtureRequest, tmp_path: Path) -> str:
    if request.param == "folder":
        return str(tmp_path / "photographs")
    s3: S3Server = request.getfixturevalue("s3")
    return s3.new_url()


@pytest.fixture
def store(url: str) -> PhotoStore:
    return open_photo_store(url)


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    return tmp_path / "photographs"


@pytest.fixture
def folder_store(folder: Path) -> PhotoStore:
    return open_photo_store(str(folder))


def files_below(folder: Path) -> list[Path]:
    return sorted(path for path in folder.rglob("*") if path.is_file())


def put(store: PhotoStore, *chunks: bytes) -> str:
    with store.receive(LIMIT) as incoming:
        for chunk in chunks:
            incoming.write(chunk)
        assert incoming.content() == b"".join(chunks)
        store.put(incoming.sha256, incoming.content())
        return incoming.sha256


def test_bytes_come_back_under_their_digest(store: PhotoStore) -> None:
    sha256 = put(store, b"one ", b"photograph")
    assert sha256 == hashlib.sha256(b"one photograph").hexdigest()
    assert store.holds(sha256)
    assert store.read(sha256) == b"one photograph"
    (item,) = store.photos()
    assert (item.name, item.size_bytes) == (sha256, len(b"one photograph"))
    assert abs(item.modified_s - time.time()) < 3600.0
    store.check()


def test_the_same_bytes_are_kept_once_and_never_touched_again(store: PhotoStore) -> None:
    sha256 = put(store, b"one photograph")
    before = list(store.photos())
    store.put(sha256, b"what is there stays")
    assert store.read(sha256) == b"one photograph"
    assert list(store.photos()) == before


def test_a_photograph_can_be_removed_more_than_once(store: PhotoStore) -> None:
    sha256, other = put(store, b"one photograph"), put(store, b"another")
    store.delete(sha256)
    store.delete(sha256)
    assert not store.holds(sha256)
    assert [item.name for item in store.photos()] == [other]


def test_a_lost_photograph_is_said_so(store: PhotoStore) -> None:
    with pytest.raises(NotFound, match="gone from the store"):
        store.read(MISSING)


def test_another_process_finds_the_same_photographs(store: PhotoStore, url: str) -> None:
    assert open_photo_store(url).read(put(store, b"one photograph")) == b"one photograph"


def test_a_kept_photograph_is_one_file_where_it_always_was(folder_store: PhotoStore, folder: Path) -> None:
    sha256 = put(folder_store, b"one photograph")
    (place,) = files_below(folder)
    assert place == folder / sha256[:2] / sha256[2:4] / sha256
    before = place.stat()
    assert put(folder_store, b"one ", b"photograph") == sha256
    assert (place.stat().st_ino, place.stat().st_mtime_ns) == (before.st_ino, before.st_mtime_ns)


def test_a_confirmed_photograph_and_its_folders_are_on_the_disk(
    folder_store: PhotoStore, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    synced: set[int] = set()
    fsync: Callable[[int], None] = os.fsync

    def record(descriptor: int) -> None:
        fsync(descriptor)
        synced.add(os.fstat(descriptor).st_ino)

    monkeypatch.setattr(os, "fsync", record)
    sha256 = put(folder_store, b"one photograph")
    place = folder / place_of(sha256)
    assert {path.stat().st_ino for path in (place, *list(place.parents)[:3])} <= synced


def test_what_arrives_has_no_name_that_could_outlive_its_process(folder_store: PhotoStore, folder: Path) -> None:
    with folder_store.receive(LIMIT) as incoming:
        incoming.write(b"half a photo")
        assert files_below(folder) == []


def test_too_many_bytes_are_refused_as_they_come(folder_store: PhotoStore, folder: Path) -> None:
    with folder_store.receive(LIMIT) as incoming:
        incoming.write(b"x" * LIMIT)
        with pytest.raises(PhotoTooLarge, match="more than 100 bytes"):
            incoming.write(b"x")
    assert files_below(folder) == []


@pytest.mark.parametrize("step", ["fsync", "replace"])
def test_a_full_disk_leaves_nothing_half_written(
    folder_store: PhotoStore, folder: Path, step: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(*_: object) -> None:
        raise OSError(28, "No space left on device")

    with monkeypatch.context() as patch:
        patch.setattr(os if step == "fsync" else Path, step, full)
        with pytest.raises(OutOfSpace, match="make room"):
            put(folder_store, b"one photograph")
    assert files_below(folder) == []
    put(folder_store, b"one photograph")


def test_what_is_no_photograph_is_none_of_the_store(folder_store: PhotoStore, folder: Path) -> None:
    sha256 = put(folder_store, b"one photograph")
    for name in ("incoming/tmp", "notes.txt", f"00/00/{sha256}", f"{place_of(sha256)}.bak"):
        place = folder / name
        place.parent.mkdir(parents=True, exist_ok=True)
        place.write_bytes(b"not ours")
    assert [item.name for item in folder_store.photos()] == [sha256]


def test_only_old_leftovers_are_swept(folder_store: PhotoStore, folder: Path) -> None:
    old, young = folder / "incoming" / "old", folder / "incoming" / "young"
    for path in (old, young):
        path.write_bytes(b"left behind")
    long_ago_s = time.time() - 2 * ABANDONED_AFTER_S
    os.utime(old, (long_ago_s, long_ago_s))
    assert folder_store.sweep(dry_run=True) == 1
    assert files_below(folder) == [old, young]
    assert folder_store.sweep() == 1
    assert files_below(folder) == [young]


def test_a_file_url_is_a_folder(tmp_path: Path) -> None:
    store = open_photo_store(f"file://{tmp_path}/photographs")
    assert store.local
    sha256 = put(store, b"one photograph")
    assert (tmp_path / "photographs" / place_of(sha256)).is_file()


def test_a_store_without_conditional_writes_is_written_all_the_same(s3: S3Server) -> None:
    store = open_photo_store(f"{s3.new_url()}&conditional_put=disabled")
    assert store.read(put(store, b"one photograph")) == b"one photograph"
    assert store.read(put(store, b"one photograph")) == b"one photograph"


def test_a_bucket_that_is_not_there_is_said_so(s3: S3Server) -> None:
    store = open_photo_store(s3.url_of("nowhere"))
    with pytest.raises(StorageUnavailable, match="make the bucket"):
        put(store, b"one photograph")
    with pytest.raises(StorageUnavailable, match="SCATTERMARK_PHOTOGRAPHS_URL"):
        store.check()


def test_a_store_that_gives_no_answer_is_said_so() -> None:
    store = open_photo_store("s3://bucket?region=us-east-1&endpoint=http://127.0.0.1:9")  # the discard port: nobody
    for ask in (store.check, lambda: store.read(MISSING), lambda: store.holds(MISSING), lambda: store.delete(MISSING)):
        with pytest.raises(StorageUnavailable, match="gave no answer") as refused:
            ask()
        assert refused.value.fields["retry_after_s"] > 0
        assert "\n" not in refused.value.detail


@pytest.mark.parametrize(
    ("url", "why"),
    [
        ("ftp://host/photographs", "names no store"),
        ("s3://bucket?nonsense=1", "names no store"),
        ("s3://bucket?aws_secret_access_key=hidden", "in the environment"),
        ("s3://bucket?session_token=hidden", "in the environment"),
    ],
)
def test_addresses_that_cannot_be_right_are_refused(url: str, why: str) -> None:
    with pytest.raises(InvalidInput, match=why) as refused:
        open_photo_store(url)
    assert "hidden" not in refused.value.detail
