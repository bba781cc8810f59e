"""Photographs on their way into a survey: whole or not at all."""

from __future__ import annotations

import asyncio
import io
from collections.abc import AsyncIterator
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from PIL import Image

from app.errors import BadPhoto, Conflict, InvalidInput, NotFound, OutOfSpace, PhotoTooLarge
from app.services.surveys import AddedPhoto, PhotoIntake, checked_filename
from app.storage.database import Database
from app.storage.photo_store import open_photo_store
from app.storage.surveys import SurveyRepository
from app.vision.photo import PhotoLimits
from tests.storage.examples import site_with_survey

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
        self.intake = PhotoIntake(database, open_photo_store(str(folder)), LIMITS)

    def take(self, *files: tuple[str, bytes], breaks_off: bool = False) -> tuple[AddedPhoto, ...]:
        chunks = [(name, in_chunks(data, breaks_off)) for name, data in files]
        return asyncio.run(self.intake.take(self.survey_id, chunks))

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


def test_an_unknown_survey_takes_nothing(survey: Survey) -> None:
    with pytest.raises(NotFound, match="no survey"):
        asyncio.run(survey.intake.take("nowhere", [("a.jpg", in_chunks(jpeg(1)))]))
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
