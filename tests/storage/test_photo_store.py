from __future__ import annotations

import hashlib
import os
import time
from pathlib import Path

import pytest

from app.errors import NotFound, PhotoTooLarge
from app.storage.photo_store import ABANDONED_AFTER_S, PhotoStore

LIMIT = 100


def files_below(folder: Path) -> list[Path]:
    return sorted(path for path in folder.rglob("*") if path.is_file())


def put(store: PhotoStore, *chunks: bytes) -> str:
    with store.receive(LIMIT) as incoming:
        for chunk in chunks:
            incoming.write(chunk)
        assert incoming.content() == b"".join(chunks)
        incoming.keep()
        return incoming.sha256


def test_bytes_come_back_under_their_digest(tmp_path: Path) -> None:
    store = PhotoStore(tmp_path / "photographs")
    sha256 = put(store, b"one ", b"photograph")
    assert sha256 == hashlib.sha256(b"one photograph").hexdigest()
    assert store.holds(sha256)
    assert store.read(sha256) == b"one photograph"
    assert [path.name for path in files_below(tmp_path)] == [sha256]


def test_the_same_bytes_are_kept_once_and_never_touched_again(tmp_path: Path) -> None:
    store = PhotoStore(tmp_path)
    sha256 = put(store, b"one photograph")
    (place,) = files_below(tmp_path)
    before = place.stat()
    assert put(store, b"one ", b"photograph") == sha256
    assert files_below(tmp_path) == [place]
    assert (place.stat().st_ino, place.stat().st_mtime_ns) == (before.st_ino, before.st_mtime_ns)


def test_what_breaks_off_leaves_nothing(tmp_path: Path) -> None:
    store = PhotoStore(tmp_path)

    def break_off() -> None:
        with store.receive(LIMIT) as incoming:
            incoming.write(b"half a photo")
            raise RuntimeError("the client broke off")

    with pytest.raises(RuntimeError, match="broke off"):
        break_off()
    assert files_below(tmp_path) == []
    assert not store.holds(hashlib.sha256(b"half a photo").hexdigest())


def test_too_many_bytes_are_refused_as_they_come(tmp_path: Path) -> None:
    store = PhotoStore(tmp_path)
    with store.receive(LIMIT) as incoming:
        incoming.write(b"x" * LIMIT)
        with pytest.raises(PhotoTooLarge, match="more than 100 bytes"):
            incoming.write(b"x")
    assert files_below(tmp_path) == []


def test_a_lost_photograph_is_said_so(tmp_path: Path) -> None:
    with pytest.raises(NotFound, match="gone from the store"):
        PhotoStore(tmp_path).read("0" * 64)


def test_only_old_leftovers_are_swept(tmp_path: Path) -> None:
    store = PhotoStore(tmp_path)
    old, young = tmp_path / "incoming" / "old", tmp_path / "incoming" / "young"
    for path in (old, young):
        path.write_bytes(b"left behind")
    long_ago_s = time.time() - 2 * ABANDONED_AFTER_S
    os.utime(old, (long_ago_s, long_ago_s))
    store.sweep()
    assert files_below(tmp_path) == [young]
