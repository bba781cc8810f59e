"""What a worker process does for one calibration: gather the detections, calibrate, keep the camera."""

from __future__ import annotations

from dataclasses import asdict, dataclass, replace
from typing import Any

from sqlalchemy.orm import Session

from app.errors import Cancelled
from app.geometry.readout import Readout
from app.geometry.target_map import TargetMap
from app.photogrammetry.calibration.calibrate import Calibration, LeftOutPhoto, SurveyPhoto, calibrate_camera
from app.services.adjust_work import AdjustTask, photos_of_job
from app.services.calibration_request import CalibrationOptions
from app.services.job_progress import JobProgress
from app.services.workbench import workbench
from app.services.write_patiently import write_patiently
from app.storage.cameras import CameraRepository
from app.storage.database import Database
from app.storage.jobs import Job, JobRepository
from app.storage.records import NewCamera, StoredCamera
from app.storage.target_maps import TargetMapRepository


@dataclass(frozen=True)
class _Material:
    """All that a calibration takes."""

    job: Job
    options: CalibrationOptions
    photos: tuple[SurveyPhoto, ...]
    target_map: TargetMap


def calibrate_and_keep(task: AdjustTask) -> str:
    """Calibrate a job's camera and keep it; its id.

    Raises
    ------
    Cancelled
        When the job was cancelled; nothing is kept.
    CalibrationFailed
        As ``calibrate_camera``.
    """
    database = workbench().database
    with database.reading() as session:
        material = _gather(session, task)
    progress = JobProgress(database, task.run)
    calibration = calibrate_camera(material.photos, material.target_map, progress=progress.report)
    unreadable = tuple(LeftOutPhoto(photo.name, "unreadable", photo.reason) for photo in task.unreadable)
    told = replace(calibration, left_out=(*unreadable, *calibration.left_out))
    return write_patiently(task.run.job_id, lambda: _keep(database, task, material, told))


def _gather(session: Session, task: AdjustTask) -> _Material:
    job = JobRepository(session).get(task.run.job_id)
    options = CalibrationOptions.from_json(job.options)
    photos = photos_of_job(session, job, task.unreadable)
    return _Material(job, options, photos, TargetMapRepository(session).load(job.site_id, options.map_version))


def _keep(database: Database, task: AdjustTask, material: _Material, calibration: Calibration) -> str:
    """The camera and the job's success in one transaction: a job that was cancelled keeps nothing."""
    options = material.options
    readout = None if options.readout_s is None else Readout(options.readout_s)
    calibrated = replace(calibration.calibrated, readout=readout)
    with database.writing() as session:
        new = NewCamera(calibration.identity, calibrated, options.device_id)
        stored = CameraRepository(session).add(new, material.job.site_id, options.map_version)
        if not JobRepository(session).succeed(task.run, calibration_result(stored, calibration)):
            raise Cancelled("the job was cancelled", job_id=task.run.job_id)
    return stored.camera_id


def calibration_result(stored: StoredCamera, calibration: Calibration) -> dict[str, Any]:
    """The result of the job: the camera, and what it was calibrated from."""
    return {
        "camera_id": stored.camera_id,
        "device_id": stored.device_id,
        "map_version": stored.map_version,
        **calibration_to_json(calibration),
        "readout_s": None if stored.calibrated.readout is None else stored.calibrated.readout.duration_s,
    }


def calibration_to_json(calibration: Calibration) -> dict[str, Any]:
    """A JSON-ready record; read as a camera by ``scattermark locate --camera``."""
    calibrated, identity = calibration.calibrated, calibration.identity
    fx, fy, cx, cy, *distortion = calibrated.camera.intrinsics.tolist()
    return {
        "make": identity.make,
        "model": identity.model,
        "width_px": identity.width_px,
        "height_px": identity.height_px,
        "fx": fx,
        "fy": fy,
        "cx": cx,
        "cy": cy,
        "dist": distortion,
        "covariance": calibrated.covariance.tolist(),
        "focal_scatter": calibration.scatter.focal,
        "centre_scatter_px": calibration.scatter.centre_px.tolist(),
        "not_carried": list(calibration.not_carried),
        "rms_residual_px": calibration.rms_residual_px,
        "targets": calibration.targets,
        "photographs": [asdict(photo) for photo in calibration.photos],
        "left_out": [asdict(photo) for photo in calibration.left_out],
        "refused_targets": [asdict(target) for target in calibration.refused_targets],
    }
