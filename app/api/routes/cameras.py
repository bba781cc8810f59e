"""Cameras: those that are known, and calibrations of others."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Depends, File, UploadFile

from app.api.dependencies import Id, Paging, PathId, ReadSession, Running, WriteSession
from app.api.problems import problems
from app.api.schemas.cameras import CalibrationForm, CamerasAnswer
from app.api.schemas.surveys import JobStarted
from app.api.schemas.texts import Text
from app.api.security import Reading, Surveying, needs
from app.api.uploads import chunks_of_file
from app.services.surveys import Upload
from app.storage.cameras import CameraRepository

router = APIRouter(tags=["cameras"])
upload_router = APIRouter(tags=["cameras"])


@router.get("/cameras", responses=problems(404, 422))
def list_cameras(
    page: Paging, session: ReadSession, principal: Reading, site_id: Id | None = None, device_id: Text | None = None
) -> CamerasAnswer:
    """Calibrated cameras, of one site or device when named."""
    return CamerasAnswer.of(CameraRepository(session).page(site_id, device_id, page, principal.site_ids))


@router.delete("/cameras/{camera_id}", dependencies=[needs("survey")], status_code=204, responses=problems(404, 422))
def delete_camera(camera_id: PathId, session: WriteSession) -> None:
    """Forget a camera: snapshots are located by the next best one that is known; poses that it gave stay."""
    CameraRepository(session).delete(camera_id)


@upload_router.post(
    "/cameras/calibrations", status_code=202, responses=problems(400, 404, 409, 413, 415, 422, 503, 507)
)
async def calibrate(
    form: Annotated[CalibrationForm, Depends(CalibrationForm.of_form)],
    principal: Surveying,
    services: Running,
    images: Annotated[
        list[UploadFile],
        File(description="5 to 20 photographs of the site's targets, if no survey has them.", default_factory=list),
    ],
) -> JobStarted:
    """Calibrate the camera that took photographs of a mapped site, sent along or in a survey: in the background.

    The job's `result`: camera_id, fx, fy, cx, cy, dist, covariance, width_px, height_px, and what took part.
    """
    principal.site(form.site_id)
    uploads = [Upload(image.filename or "", chunks_of_file(image), image.size or 0) for image in images]
    return JobStarted(job_id=(await services.calibrations.take(form.to_domain(), uploads)).job_id)
