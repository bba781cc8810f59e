"""Surveys, their photographs and their builds."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Body, Depends, File, Response, UploadFile

from app.api.dependencies import Paging, PathId, ReadSession, Running, WriteSession
from app.api.problems import problems
from app.api.schemas.guidance import GuidanceAnswer
from app.api.schemas.surveys import (
    BuildBody,
    JobStarted,
    NewSurveyBody,
    PhotosAnswer,
    SurveyAnswer,
    SurveysAnswer,
    UploadAnswer,
    UploadedPhotoAnswer,
)
from app.api.security import needs
from app.api.uploads import IMAGE_BODY, chunks_of_file, upload_of_body
from app.services import build_request, surveys
from app.services.surveys import Upload
from app.storage.surveys import SurveyRepository

router = APIRouter(tags=["surveys"])
photo_router = APIRouter(tags=["surveys"])
upload_router = APIRouter(tags=["surveys"])


@router.post(
    "/sites/{site_id}/surveys", dependencies=[needs("survey")], status_code=201, responses=problems(400, 404, 413, 422)
)
def open_survey(
    site_id: PathId, session: WriteSession, body: Annotated[NewSurveyBody | None, Body()] = None
) -> SurveyAnswer:
    """Open a survey for photographs."""
    wanted = body or NewSurveyBody()
    return SurveyAnswer.of(surveys.open_survey(session, site_id, wanted.note, wanted.device_id))


@router.get("/sites/{site_id}/surveys", dependencies=[needs("survey")], responses=problems(404, 422))
def list_surveys(site_id: PathId, page: Paging, session: ReadSession) -> SurveysAnswer:
    """The surveys of a site in the order they were opened."""
    return SurveysAnswer.of(SurveyRepository(session).page(site_id, page))


@router.get("/surveys/{survey_id}", dependencies=[needs("survey")], responses=problems(404, 422))
def get_survey(survey_id: PathId, session: ReadSession) -> SurveyAnswer:
    """One survey."""
    return SurveyAnswer.of(SurveyRepository(session).get(survey_id))


@router.get("/surveys/{survey_id}/images", dependencies=[needs("survey")], responses=problems(404, 422))
def list_photos(survey_id: PathId, page: Paging, session: ReadSession) -> PhotosAnswer:
    """The photographs of a survey by name."""
    return PhotosAnswer.of(SurveyRepository(session).photo_page(survey_id, page))


@router.get("/surveys/{survey_id}/guidance", dependencies=[needs("survey")], responses=problems(404, 422, 503, 504))
async def get_guidance(survey_id: PathId, services: Running) -> GuidanceAnswer:
    """What targets lack so far and from where to photograph them next; from now on what comes in is looked at."""
    return GuidanceAnswer.of(await services.guide.guidance(survey_id))


@photo_router.put(
    "/surveys/{survey_id}/images/{filename}",
    dependencies=[needs("survey")],
    status_code=201,
    responses={200: {"model": UploadedPhotoAnswer}, **problems(404, 409, 413, 415, 422, 503, 507)},
    openapi_extra={"requestBody": IMAGE_BODY},
)
async def put_photo(
    survey_id: PathId, upload: Annotated[Upload, Depends(upload_of_body)], response: Response, services: Running
) -> UploadedPhotoAnswer:
    """Upload one photograph as raw body; 200 when the same bytes are there, so an interrupted upload resumes.

    A position on the Earth in its metadata is not stored; bytes and sha256 of the answer are those that were sent.
    """
    (added,) = await services.intake.take(survey_id, [upload])
    response.status_code = 201 if added.created else 200
    return UploadedPhotoAnswer.of_upload(added)


@upload_router.post(
    "/surveys/{survey_id}/images",
    dependencies=[needs("survey")],
    status_code=201,
    responses=problems(400, 404, 409, 413, 415, 422, 503, 507),
)
async def post_photos(
    survey_id: PathId, images: Annotated[list[UploadFile], File(min_length=1)], services: Running
) -> UploadAnswer:
    """Upload photographs as a form, all or none."""
    uploads = [Upload(image.filename or "", chunks_of_file(image), image.size or 0) for image in images]
    added = await services.intake.take(survey_id, uploads)
    return UploadAnswer(images=[UploadedPhotoAnswer.of_upload(photo) for photo in added])


@router.post(
    "/surveys/{survey_id}/build",
    dependencies=[needs("survey")],
    status_code=202,
    responses=problems(400, 404, 409, 413, 422),
)
def build(survey_id: PathId, session: WriteSession, body: Annotated[BuildBody | None, Body()] = None) -> JobStarted:
    """Detect in each photograph, adjust, publish a new target map of this survey: in the background."""
    options = (body or BuildBody()).to_domain()
    return JobStarted(job_id=build_request.request_build(session, survey_id, options).job_id)
