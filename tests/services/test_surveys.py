"""Photographs on their way into a survey: whole or not at all."""

from __future__ import annotations

import asyncio
import hashlib
import io
from collections.abc import AsyncIterator
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from PIL import Image

from app.errors import BadPhoto, Conflict, InvalidInput, NotFound, OutOfSpace, PhotoTooLarge
from app.services.storage_budget import StorageBudget, StorageLimits
from app.services.surveys import AddedPhoto, DigestMismatch, PhotoIntake, Upload, checked_filename
from app.storage.database import Database
from app.storage.photo_store import open_photo_store
from app.storage.surveys import SurveyRepository
from app.vision.photo import PhotoLimits
from tests.storage.examples import site_with_survey
from tests.vision.privacy.hiding import Place, exif_block, jpeg_with, segment

LIMITS = PhotoLimits(max_bytes=200_000, max_pixels=100_000)


def jpeg(seed: int, width_px: int = 64, height_px: int = 48) -> bytes:
    pixels = np.random.default_rng(seed).integers(0, 255, (height_px, width_px, 3), dtype=np.uint8)
    buffer = io.BytesIO()
    Image.fromarray(pixels).save(buffer, "JPEG")
    return buffer.getvalue()


async def in_chunks(data: bytes, breaks_off: bool = False) -> AsyncIterator[bytes]:
    for start in range(0, len(data), 1000):
        yield data[start : start + 1000]
    if breaks_off:
        raise BadPhoto("the upload broke off")


class Survey:
    """A survey with its photo store."""

    def __init__(self, database: Database, folder: Path) -> None:
        self.database, self.folder = database, folder
        _, self.survey_id = site_with_survey(database)
        self.photos = open_photo_store(str(folder))
        self.limit(StorageLimits())

    def limit(self, limits: StorageLimits) -> None:
        budget = StorageBudget(self.database, self.photos, limits)
        self.intake = PhotoIntake(self.database, self.photos, LIMITS, budget)

    def take(
        self, *files: tuple[str, bytes], breaks_off: bool = False, sha256: str | None = None
    ) -> tuple[AddedPhoto, ...]:
        uploads = [Upload(name, in_chunks(data, breaks_off), sha256=sha256) for name, data in files]
        return asyncio.run(self.intake.take(self.survey_id, uploads))

    @property
    def names(self) -> list[str]:
        with self.database.reading() as session:
            return [photo.name for photo in SurveyRepository(session).photos(self.survey_id)]

    @property
    def files(self) -> int:
        return sum(path.is_file() for path in self.folder.rglob("*"))


@pytest.fixture
def survey(database: Database, tmp_path: Path) -> Survey:
    return Survey(database, tmp_path / "photographs")


def test_photographs_are_kept_and_listed(survey: Survey) -> None:
    first, second = survey.take(("b.jpg", jpeg(1)), ("a.jpg", jpeg(2)))
    assert (first.created, second.created) == (True, True)
    assert (first.photo.identity.width_px, first.photo.identity.height_px) == (64, 48)
    assert survey.names == ["a.jpg", "b.jpg"]
    assert survey.files == 2


def test_a_repeat_changes_nothing_and_twins_share_a_file(survey: Survey) -> None:
    survey.take(("a.jpg", jpeg(1)))
    (again,) = survey.take(("a.jpg", jpeg(1)))
    assert not again.created
    survey.take(("b.jpg", jpeg(1)))
    assert survey.names == ["a.jpg", "b.jpg"]
    assert survey.files == 1


def test_all_or_none_of_a_request_is_kept(survey: Survey) -> None:
    survey.take(("taken.jpg", jpeg(1)))
    for refused, error in (
        (("bad.jpg", b"no image"), BadPhoto),
        (("empty.jpg", b""), BadPhoto),
        (("large.jpg", jpeg(3, 400, 300)), PhotoTooLarge),
        (("../path.jpg", jpeg(3)), InvalidInput),
        (("taken.jpg", jpeg(3)), Conflict),
    ):
        with pytest.raises(error, match=refused[0].removeprefix("../")):
            survey.take(("good.jpg", jpeg(2)), refused)
    assert survey.names == ["taken.jpg"]
    assert survey.files == 1


def test_what_breaks_off_leaves_nothing(survey: Survey) -> None:
    with pytest.raises(BadPhoto, match="broke off"):
        survey.take(("a.jpg", jpeg(1)), breaks_off=True)
    assert survey.names == []
    assert survey.files == 0


def test_too_many_bytes_are_refused_as_they_come(survey: Survey) -> None:
    with pytest.raises(PhotoTooLarge, match="more than 200000 bytes"):
        survey.take(("a.jpg", b"\xff" * (LIMITS.max_bytes + 1)))
    assert survey.files == 0


def test_a_full_disk_undoes_the_rows(survey: Survey, monkeypatch: pytest.MonkeyPatch) -> None:
    def full(_path: Path, _target: Path) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(Path, "replace", full)
    with pytest.raises(OutOfSpace, match="make room"):
        survey.take(("a.jpg", jpeg(1)))
    assert survey.names == []
    assert survey.files == 0


def test_what_is_stored_has_no_position_and_the_client_knows_it_by_what_it_sent(survey: Survey) -> None:
    place = Place(52.123456, 13.654321)
    sent = jpeg_with(segment(0xE1, exif_block(place)))
    (added,) = survey.take(("a.jpg", sent))
    photo = added.photo
    assert (photo.sent_sha256, photo.sent_bytes) == (hashlib.sha256(sent).hexdigest(), len(sent))
    stored = survey.photos.read(photo.sha256)
    assert (hashlib.sha256(stored).hexdigest(), len(stored)) == (photo.sha256, photo.size_bytes)
    assert not any(trace in stored for trace in place.traces)
    assert (photo.identity.model, photo.captured_at) == ("Phone 3", "2026:02:03 04:05:06")
    (again,) = survey.take(("a.jpg", sent))
    assert not again.created
    elsewhere = jpeg_with(segment(0xE1, exif_block(Place(1.5, 2.5))))
    with pytest.raises(Conflict, match=r"a\.jpg"):
        survey.take(("a.jpg", elsewhere))
    survey.take(("b.jpg", elsewhere))  # where it was taken was all that differed
    assert survey.files == 1


def test_bytes_that_were_not_announced_are_refused(survey: Survey) -> None:
    data = jpeg(1)
    with pytest.raises(DigestMismatch, match=r"a\.jpg: other bytes arrived"):
        survey.take(("a.jpg", data), sha256=hashlib.sha256(b"others").hexdigest())
    assert (survey.names, survey.files) == ([], 0)
    survey.take(("a.jpg", data), sha256=hashlib.sha256(data).hexdigest())
    assert survey.names == ["a.jpg"]


def test_the_quota_counts_what_is_stored_once(survey: Survey) -> None:
    first, second = jpeg(1), jpeg(2)
    survey.limit(StorageLimits(quota_bytes=len(first) + 10))
    survey.take(("a.jpg", first))
    with pytest.raises(OutOfSpace, match="SCATTERMARK_QUOTA_BYTES") as refused:
        survey.take(("b.jpg", second))
    assert refused.value.fields == {"used_bytes": len(first), "quota_bytes": len(first) + 10}
    assert (survey.names, survey.files) == (["a.jpg"], 1)
    survey.take(("a.jpg", first))  # takes no room
    survey.limit(StorageLimits(quota_bytes=len(first) + len(second)))
    survey.take(("b.jpg", second))


def test_room_on_the_disk_is_left_to_others(survey: Survey) -> None:
    survey.limit(StorageLimits(min_free_bytes=2**62))
    with pytest.raises(OutOfSpace, match="SCATTERMARK_MIN_FREE_BYTES"):
        survey.take(("a.jpg", jpeg(1)))
    assert (survey.names, survey.files) == ([], 0)


def test_a_file_that_a_purge_takes_before_its_row_is_there_is_put_once_more(
    survey: Survey, monkeypatch: pytest.MonkeyPatch
) -> None:
    put, puts = survey.photos.put, list[str]()

    def put_and_lose(sha256: str, data: bytes) -> None:
        puts.append(sha256)
        put(sha256, data)
        if len(puts) == 1:
            survey.photos.delete(sha256)

    monkeypatch.setattr(survey.photos, "put", put_and_lose)
    (added,) = survey.take(("a.jpg", jpeg(1)))
    assert survey.photos.read(added.photo.sha256) == jpeg(1)
    assert len(puts) == 2


def test_an_unknown_survey_takes_nothing(survey: Survey) -> None:
    with pytest.raises(NotFound, match="no survey"):
        asyncio.run(survey.intake.take("nowhere", [Upload("a.jpg", in_chunks(jpeg(1)))]))
    assert survey.files == 0


@pytest.mark.parametrize("name", ["IMG_0000.jpg", "Büro (3).jpeg", "20260501_093000~2.JPG", "写真.png"])
def test_names_of_cameras_and_people_are_taken(name: str) -> None:
    assert checked_filename(name) == name


@pytest.mark.parametrize(
    "name",
    ["", ".", "..", ".hidden", "a/b.jpg", "..\\b.jpg", "a\0.jpg", "a\n.jpg", "-rf", " a.jpg", "<b>.jpg", "x" * 151],
)
def test_paths_and_traps_are_refused(name: str) -> None:
    with pytest.raises(InvalidInput, match="no usable file name"):
        checked_filename(name)


@given(st.text(max_size=200))
def test_a_name_that_is_taken_is_never_a_path(name: str) -> None:
    try:
        checked = checked_filename(name)
    except InvalidInput:
        return
    assert Path("/photos", checked).parent == Path("/photos")
    assert checked.isprintable()
    assert 0 < len(checked) <= 150
