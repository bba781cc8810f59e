"""An archive that is not whole, not ours or not honest is refused; what is read is what was written."""

from __future__ import annotations

import hashlib
import io
import json
import random
import zipfile
from collections.abc import Callable, Iterator
from typing import Any

import pytest

from app.storage.archive_format import MANIFEST_NAME, BadArchive, Heading, Manifest
from app.storage.archive_reader import ArchiveReader
from app.storage.archive_writer import ArchiveWriter

HEADING = Heading("backup", "0003", "0.1.0", 1.78e9)
LINES = [b'["%d",%d]\n' % (number, number * number) for number in range(300)]
PHOTOS = [b"one photograph", b"another photograph, a little longer"]


def archive() -> bytes:
    out = io.BytesIO()
    with ArchiveWriter(out) as writer:
        writer.add_table("squares", ("id", "square"), LINES)
        writer.add_table("nothing", ("id",), [])
        for data in PHOTOS:
            writer.add_photo(hashlib.sha256(data).hexdigest(), data)
        writer.finish(HEADING, with_photographs=True)
    return out.getvalue()


GOOD = archive()
NO_ROWS = {"name": "nothing", "columns": ["id"], "rows": 0, "size_bytes": 0, "sha256": hashlib.sha256().hexdigest()}


def read(data: bytes, max_bytes: int | None = None) -> tuple[Manifest, list[bytes], list[bytes]]:
    with ArchiveReader(io.BytesIO(data), max_bytes) as reader:
        reader.verify(lambda *_: None)
        return reader.manifest, list(reader.lines("squares")), [reader.photo(sha256) for sha256 in reader.photos]


def test_what_is_read_is_what_was_written() -> None:
    manifest, lines, photos = read(GOOD)
    assert (manifest.heading, manifest.rows, manifest.photographs.count) == (HEADING, 300, 2)
    assert (lines, photos) == (LINES, PHOTOS)


def test_the_same_content_gives_the_same_bytes() -> None:
    assert archive() == GOOD


def test_an_archive_of_many_digests_reports_its_way() -> None:
    told: list[tuple[str, int, int]] = []
    with ArchiveReader(io.BytesIO(GOOD)) as reader:
        reader.verify(lambda *step: told.append(step))
    assert told[-1] == ("check", 4, 4)


@pytest.mark.parametrize("length", [0, 1, 30, len(GOOD) // 2, len(GOOD) - 25, len(GOOD) - 1])
def test_a_truncated_archive(length: int) -> None:
    with pytest.raises(BadArchive):
        read(GOOD[:length])


def test_no_flipped_bit_goes_by_unnoticed() -> None:
    """Each bit either matters, and is refused, or does not, as a date that nobody reads."""
    generator = random.Random(4)
    refused = 0
    for _ in range(600):
        flipped = bytearray(GOOD)
        flipped[generator.randrange(len(GOOD))] ^= 1 << generator.randrange(8)
        try:
            manifest, lines, photos = read(bytes(flipped))
        except BadArchive:
            refused += 1
        else:
            assert (manifest.heading, lines, sorted(photos)) == (HEADING, LINES, sorted(PHOTOS))
    assert refused > 300


def rewritten(change: Callable[[dict[str, bytes]], None], compression: int | None = None) -> bytes:
    """The good archive with other members."""
    with zipfile.ZipFile(io.BytesIO(GOOD)) as before:
        kinds = {entry.filename: entry.compress_type for entry in before.infolist()}
        members = {name: before.read(name) for name in kinds}
    change(members)
    out = io.BytesIO()
    with zipfile.ZipFile(out, "w") as after:
        for name, data in members.items():
            kind = zipfile.ZIP_STORED if name.startswith("photo") else zipfile.ZIP_DEFLATED
            after.writestr(name, data, compression if compression is not None else kind)
    return out.getvalue()


def in_manifest(**changes: Any) -> Callable[[dict[str, bytes]], None]:
    def change(members: dict[str, bytes]) -> None:
        members[MANIFEST_NAME] = json.dumps({**json.loads(members[MANIFEST_NAME]), **changes}).encode()

    return change


def replaced(name: str, data: bytes) -> Callable[[dict[str, bytes]], None]:
    def change(members: dict[str, bytes]) -> None:
        members[name] = data

    return change


def removed(name: str) -> Callable[[dict[str, bytes]], None]:
    def change(members: dict[str, bytes]) -> None:
        del members[name]

    return change


def test_the_rewriting_alone_harms_nothing() -> None:
    assert read(rewritten(lambda _: None))[1] == LINES


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (removed(MANIFEST_NAME), "no manifest"),
        (replaced(MANIFEST_NAME, b"{}"), "says something else"),
        (replaced(MANIFEST_NAME, b"[" * 10_000), "cannot be read"),
        (in_manifest(format_version=2), "install the release"),
        (in_manifest(heading={"kind": "backup"}), "cannot be read"),
        (in_manifest(heading={"kind": "x", "revision": "1", "app_version": "1", "created_s": 1.0}), "no kind"),
        (in_manifest(tables=[]), "no place"),
        (in_manifest(tables=[{**NO_ROWS, "name": "../x"}]), "no table"),
        (in_manifest(photographs={"included": True, "count": 1, "size_bytes": 14, "missing": []}), "holds 2"),
        (in_manifest(photographs={"included": True, "count": 2, "size_bytes": 49, "missing": [7]}), "cannot be read"),
        (removed("tables/squares.jsonl"), "missing"),
        (replaced("tables/squares.jsonl", b"[]\n"), "another length"),
        (replaced("tables/squares.jsonl", b"".join(LINES).replace(b"7", b"8")), "not what it was"),
        (replaced("photographs/../../../etc/passwd", b""), "no place"),
        (replaced("../../outside", b""), "no place"),
        (replaced("/etc/passwd", b""), "no place"),
        (replaced("photographs/" + "A" * 64, b""), "no place"),
    ],
)
def test_an_archive_that_was_tampered_with(change: Callable[[dict[str, bytes]], None], words: str) -> None:
    with pytest.raises(BadArchive, match=words):
        read(rewritten(change))


def test_a_photograph_under_the_name_of_another() -> None:
    digests = [hashlib.sha256(data).hexdigest() for data in PHOTOS]

    def exchange(members: dict[str, bytes]) -> None:
        first, second = (f"photographs/{digest}" for digest in digests)
        members[first], members[second] = members[second], members[first]

    with pytest.raises(BadArchive, match="other bytes"):
        read(rewritten(exchange))


def test_photographs_that_are_packed_are_refused() -> None:
    """Stored bytes cannot grow when they are read."""
    with pytest.raises(BadArchive, match="packed in a way"):
        read(rewritten(lambda _: None, zipfile.ZIP_DEFLATED))


def test_a_bomb_is_refused_before_it_is_unpacked() -> None:
    with pytest.raises(BadArchive, match="unpacks to"):
        read(GOOD, max_bytes=1000)


def test_a_bomb_that_lies_about_its_size() -> None:
    """A member is read as far as its directory entry says, whatever else comes out of it."""
    rows = b"x" * 10_000_000 + b"\n"
    digest = hashlib.sha256(rows).hexdigest()
    table = {"name": "squares", "columns": ["id"], "rows": 1, "size_bytes": 20, "sha256": digest}

    def change(members: dict[str, bytes]) -> None:
        in_manifest(tables=[table, NO_ROWS])(members)
        members["tables/squares.jsonl"] = rows

    bomb = rewritten(change).replace((10_000_001).to_bytes(4, "little"), (20).to_bytes(4, "little"))
    with pytest.raises(BadArchive, match="damaged"):
        read(bomb, max_bytes=1000)


def test_members_that_share_their_bytes() -> None:
    with zipfile.ZipFile(io.BytesIO(GOOD)) as before:
        entries = before.infolist()
    out = io.BytesIO(GOOD)
    with zipfile.ZipFile(out, "a") as after:
        for entry in entries[:1] * 5:
            twin = zipfile.ZipInfo("tables/twin.jsonl")
            twin.compress_type, twin.CRC = entry.compress_type, entry.CRC
            twin.compress_size, twin.file_size, twin.header_offset = len(GOOD), entry.file_size, entry.header_offset
            after.filelist.append(twin)
        after._didModify = True  # type: ignore[attr-defined]
    with pytest.raises(BadArchive, match=r"twice|overlap"):
        read(out.getvalue())


def test_after_an_error_no_directory_is_written() -> None:
    def broken() -> Iterator[bytes]:
        yield LINES[0]
        raise ZeroDivisionError

    out = io.BytesIO()
    with pytest.raises(ZeroDivisionError), ArchiveWriter(out) as writer:
        writer.add_table("squares", ("id", "square"), broken())
    with pytest.raises(BadArchive):
        read(out.getvalue())
