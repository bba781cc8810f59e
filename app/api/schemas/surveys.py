"""Surveys, their photographs, builds and jobs."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import BaseModel, Field

from app.api.dependencies import GREATEST_INTEGER
from app.api.problems import Problem, kind_of_slug, problem_of
from app.api.schemas.common import WHOLE, Body, Listing, Truth, time_of
from app.api.schemas.texts import LongText, Text
from app.services.build_options import BuildOptions, Exclusion
from app.services.job_kinds import BUILD
from app.services.surveys import AddedPhoto
from app.storage.jobs import Job
from app.storage.paging import Page
from app.storage.records import StoredPhoto, Survey
from app.targets.digits import CODE_COUNT


class NewSurveyBody(Body):
    """A survey to be opened."""

    note: LongText = ""
    device_id: Annotated[Text | None, Field(description="The device that takes the photographs, if it is one.")] = None


class SurveyAnswer(BaseModel):
    """A survey."""

    survey_id: str
    site_id: str
    note: str
    device_id: str | None
    created_at: str

    @classmethod
    def of(cls, survey: Survey) -> SurveyAnswer:
        """The answer for a survey."""
        return cls(
            survey_id=survey.survey_id,
            site_id=survey.site_id,
            note=survey.note,
            device_id=survey.device_id,
            created_at=time_of(survey.created_s),
        )


class SurveysAnswer(Listing):
    """A page of surveys."""

    surveys: list[SurveyAnswer]

    @classmethod
    def of(cls, page: Page[Survey]) -> SurveysAnswer:
        """The answer for a page."""
        return cls(surveys=[SurveyAnswer.of(survey) for survey in page.items], next_cursor=page.next_cursor)


class PhotoAnswer(BaseModel):
    """A photograph of a survey."""

    name: str
    bytes: int = Field(description="As they were sent; what is stored has no position on the Earth.")
    sha256: str = Field(description="Of the bytes as they were sent.")
    width_px: int
    height_px: int
    camera: str = Field(description="Make and model as EXIF tells them, empty when it does not.")
    created_at: str

    @classmethod
    def of(cls, photo: StoredPhoto) -> PhotoAnswer:
        """The answer for a photograph."""
        return cls(
            name=photo.name,
            bytes=photo.sent_bytes,
            sha256=photo.sent_sha256,
            width_px=photo.identity.width_px,
            height_px=photo.identity.height_px,
            camera=f"{photo.identity.make} {photo.identity.model}".strip(),
            created_at=time_of(photo.created_s),
        )


class PhotosAnswer(Listing):
    """A page of photographs."""

    images: list[PhotoAnswer]

    @classmethod
    def of(cls, page: Page[StoredPhoto]) -> PhotosAnswer:
        """The answer for a page."""
        return cls(images=[PhotoAnswer.of(photo) for photo in page.items], next_cursor=page.next_cursor)


class UploadedPhotoAnswer(PhotoAnswer):
    """A photograph after its upload."""

    created: bool = Field(description="False when the same bytes were there already.")

    @classmethod
    def of_upload(cls, added: AddedPhoto) -> UploadedPhotoAnswer:
        """The answer for an upload."""
        return cls(**PhotoAnswer.of(added.photo).model_dump(), created=added.created)


class UploadAnswer(BaseModel):
    """Photographs after their upload."""

    images: list[UploadedPhotoAnswer]


GivenName = Annotated[str, Field(min_length=1, description="As it was given.")]
Code = Annotated[int, Field(strict=True, ge=0, lt=CODE_COUNT), WHOLE]
VersionNumber = Annotated[int, Field(strict=True, ge=1, le=GREATEST_INTEGER), WHOLE]


class ExclusionBody(Body):
    """What a build shall leave out."""

    images: tuple[GivenName, ...] = ()
    codes: tuple[Code, ...] = ()
    control_points: tuple[GivenName, ...] = ()


class BuildBody(Body):
    """Options of a build."""

    exclude: ExclusionBody = ExclusionBody()
    strictness: Literal["strict", "normal", "eager"] = "normal"
    activate: Annotated[Truth, Field(description="Whether snapshots are located in the new map at once.")] = True
    base_version: VersionNumber | None = Field(default=None, description="The map that is extended; its datum stands.")

    def to_domain(self) -> BuildOptions:
        """The options as services know them."""
        exclude = Exclusion(self.exclude.images, self.exclude.codes, self.exclude.control_points)
        return BuildOptions(exclude, self.strictness, self.activate, self.base_version)


class JobStarted(BaseModel):
    """A job that waits for its turn."""

    job_id: str


class JobAnswer(BaseModel):
    """How far a job is."""

    job_id: str
    state: Literal["queued", "running", "succeeded", "failed", "cancelled"]
    stage: str = Field(description="What is being done; during 'detect', done and total count photographs.")
    done: int
    total: int
    error: Problem | None = None
    result: dict[str, Any] | None = None
    site_id: str
    survey_id: str
    created_at: str
    finished_at: str | None

    @classmethod
    def of(cls, job: Job) -> JobAnswer:
        """The answer for a job."""
        return cls(
            job_id=job.job_id,
            state=job.state,
            stage=job.stage,
            done=job.done,
            total=job.total,
            error=_error(job),
            result=_result(job),
            site_id=job.site_id,
            survey_id=job.survey_id,
            created_at=time_of(job.created_s),
            finished_at=None if job.finished_s is None else time_of(job.finished_s),
        )


class JobsAnswer(Listing):
    """A page of jobs."""

    jobs: list[JobAnswer]

    @classmethod
    def of(cls, page: Page[Job]) -> JobsAnswer:
        """The answer for a page."""
        return cls(jobs=[JobAnswer.of(job) for job in page.items], next_cursor=page.next_cursor)


def _error(job: Job) -> Problem | None:
    if job.error is None:
        return None
    slug = job.error["slug"]
    return Problem(**problem_of(slug, kind_of_slug(slug), job.error["detail"], job.error["fields"]))


def _result(job: Job) -> dict[str, Any] | None:
    if job.result is None or job.kind != BUILD:
        return job.result
    return {**job.result, "report_url": f"/sites/{job.site_id}/report?version={job.result['map_version']}"}
