"""One photograph of a survey: its picture, what was seen in it, what a person marked in it."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Depends, Header, Path, Query, Response
from pydantic import AfterValidator

from app.api.dependencies import PathId, ReadSession, Running, WriteSession
from app.api.entity_tags import headers_of, holds
from app.api.problems import problems
from app.api.routes.snapshots import MEDIA_TYPES, PICTURE
from app.api.schemas.photo_marks import MarksAnswer, MarksBody
from app.api.schemas.survey_photos import DetectionAnswer
from app.api.security import needs
from app.errors import InvalidInput, NotFound
from app.services import photo_marks
from app.services.build_options import Strictness
from app.services.surveys import checked_filename
from app.vision.display import DisplayOptions

router = APIRouter(tags=["surveys"])

GREATEST_WIDTH_PX = 8192  # as wide as browsers draw a picture
NOT_MODIFIED = {"description": "The client has it already."}
Reading = Annotated[Strictness, Query(description="How much evidence a target needs to be believed.")]


def _of_a_photograph(filename: str) -> str:
    """A name as surveys store it; what none can have names nothing."""
    try:
        return checked_filename(filename)
    except InvalidInput as error:
        raise NotFound(f"no survey has a photograph {filename[:100]!r}: {error.detail}", filename=filename) from error


Filename = Annotated[str, Path(), AfterValidator(_of_a_photograph)]


def wanted_picture(
    width_px: Annotated[
        int | None,
        Query(ge=16, le=GREATEST_WIDTH_PX, description="A JPEG at most this wide before it is turned; else as stored."),
    ] = None,
    upright: Annotated[
        bool, Query(description="Turned as EXIF says; false: as the sensor's rows lie. With width_px only.")
    ] = True,
) -> DisplayOptions | None:
    """How a photograph is wanted; None as it is stored."""
    return None if width_px is None else DisplayOptions(width_px, upright)


@router.get(
    "/surveys/{survey_id}/images/{filename}",
    dependencies=[needs("survey")],
    response_class=Response,
    responses={
        200: {"content": PICTURE, "description": "The picture"},
        304: NOT_MODIFIED,
        **problems(404, 413, 415, 422, 503, 504),
    },
)
async def get_photo(
    survey_id: PathId,
    filename: Filename,
    services: Running,
    wanted: Annotated[DisplayOptions | None, Depends(wanted_picture)],
    if_none_match: Annotated[str, Header()] = "",
) -> Response:
    """A photograph as it is stored, or a smaller picture of it to look at; neither tells a position on the Earth."""
    photo = await services.viewer.find(survey_id, filename)
    tag = photo.sha256 if wanted is None else f"{photo.sha256}-{wanted.width_px}-{int(wanted.upright)}"
    if holds(if_none_match, tag):
        return Response(status_code=304, headers=headers_of(tag))
    if wanted is None:
        original = await services.viewer.original(photo)
        return Response(original.data, media_type=MEDIA_TYPES[original.format], headers=headers_of(tag))
    shown = await services.viewer.picture(photo, wanted)
    return Response(shown, media_type=MEDIA_TYPES["JPEG"], headers=headers_of(tag))


@router.get(
    "/surveys/{survey_id}/images/{filename}/detection",
    dependencies=[needs("survey")],
    responses=problems(404, 422, 503, 504),
)
async def get_detection(
    survey_id: PathId, filename: Filename, services: Running, strictness: Reading = "normal"
) -> DetectionAnswer:
    """What was found in a photograph, what was refused and why; it is looked at now if nobody did."""
    return DetectionAnswer.of(await services.viewer.seen(survey_id, filename, strictness))


@router.get(
    "/surveys/{survey_id}/images/{filename}/marks", dependencies=[needs("survey")], responses=problems(404, 422)
)
def get_marks(survey_id: PathId, filename: Filename, session: ReadSession) -> MarksAnswer:
    """The dots that were marked by hand in a photograph."""
    return MarksAnswer.of(photo_marks.get_marks(session, survey_id, filename))


@router.put(
    "/surveys/{survey_id}/images/{filename}/marks",
    dependencies=[needs("survey")],
    responses=problems(400, 404, 413, 422),
)
def put_marks(survey_id: PathId, filename: Filename, body: MarksBody, session: WriteSession) -> MarksAnswer:
    """Replace the marks of a photograph; the next build takes them as measured, before what a detector saw there."""
    return MarksAnswer.of(photo_marks.put_marks(session, survey_id, filename, body.to_domain()))


@router.delete(
    "/surveys/{survey_id}/images/{filename}/marks",
    status_code=204,
    dependencies=[needs("survey")],
    responses=problems(404, 422),
)
def delete_marks(survey_id: PathId, filename: Filename, session: WriteSession) -> None:
    """Remove all marks of a photograph."""
    photo_marks.put_marks(session, survey_id, filename, ())
