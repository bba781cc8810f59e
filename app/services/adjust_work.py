"""What a worker process does for one build: gather the detections, adjust the survey, publish the map."""

from __future__ import annotations

from dataclasses import asdict, dataclass, replace

from sqlalchemy.orm import Session

from app.errors import Cancelled
from app.geometry.control import ControlPoint
from app.geometry.observations import Detection
from app.geometry.print_batch import PrintBatch
from app.geometry.target_map import TargetMap
from app.photogrammetry.hand_marks import FEWEST_MARKS, with_marks
from app.photogrammetry.survey import PlateSpec, SurveyOptions, SurveyPhoto, SurveyResult, adjust_survey
from app.services.build_options import BuildOptions
from app.services.detect_work import DetectSettings
from app.services.extend_map import extend_map
from app.services.job_kinds import reading_options
from app.services.job_progress import JobProgress
from app.services.photo_results import photo_results
from app.services.tied_survey import Tie, adjust_tied
from app.services.workbench import workbench
from app.services.write_patiently import write_patiently
from app.storage.database import Database
from app.storage.jobs import Job, JobRepository, JobRun
from app.storage.marks import MarkRepository
from app.storage.print_batches import PrintBatchRepository
from app.storage.records import NewCamera, Origin, PhotoResult, Publication, Site, Survey
from app.storage.sites import SiteRepository
from app.storage.surveys import DetectionRepository, SurveyRepository
from app.storage.target_maps import TargetMapRepository


@dataclass(frozen=True)
class Unreadable:
    """A photograph that the detector could not use, and why."""

    name: str
    reason: str


@dataclass(frozen=True)
class AdjustTask:
    """The attempt at a build whose detections are complete."""

    run: JobRun
    unreadable: tuple[Unreadable, ...]


@dataclass(frozen=True)
class _Material:
    """All that the adjustment takes."""

    job: Job
    run: JobRun
    options: BuildOptions
    site: Site
    survey: Survey
    photos: tuple[SurveyPhoto, ...]
    points: tuple[ControlPoint, ...]
    batches: tuple[PrintBatch, ...]
    warnings: tuple[str, ...]
    base: TargetMap | None


def adjust_and_publish(task: AdjustTask) -> int:
    """Adjust a build's survey and publish its map; the version's number.

    Raises
    ------
    Cancelled
        When the job was cancelled; nothing is published.
    SurveyFailed, InvalidControlPoints
        As ``adjust_survey``.
    """
    database = workbench().database
    with database.reading() as session:
        material = _gather(session, task)
    plate = PlateSpec(material.site.code_family, material.site.plate_u_m, material.batches)
    progress = JobProgress(database, task.run)
    if material.base is None:
        result = adjust_survey(material.photos, material.points, plate, SurveyOptions(), progress.report)
    else:
        result = adjust_tied(material.photos, Tie(material.base, material.points, material.batches), progress.report)
    publication = _publication(material, result, task.unreadable)
    return write_patiently(task.run.job_id, lambda: _publish(database, material, publication))


def _gather(session: Session, task: AdjustTask) -> _Material:
    job = JobRepository(session).get(task.run.job_id)
    options = BuildOptions.from_json(job.options)
    site = SiteRepository(session).get(job.site_id)
    points = options.exclude.points_left(SiteRepository(session).control_points(job.site_id))
    photos = photos_of_job(session, job, task.unreadable)
    survey = SurveyRepository(session).get(job.survey_id)
    warnings = _unused_marks(session, job, photos)
    batches = PrintBatchRepository(session).of_site(job.site_id)
    if options.base_version is None:
        return _Material(job, task.run, options, site, survey, photos, points, batches, warnings, None)
    base = TargetMapRepository(session).load(job.site_id, options.base_version)
    return _Material(job, task.run, options, site, survey, photos, points, batches, warnings, base)


def photos_of_job(session: Session, job: Job, unreadable: tuple[Unreadable, ...]) -> tuple[SurveyPhoto, ...]:
    """What was seen in each photograph of a job, without what it leaves out."""
    options, detections = reading_options(job), DetectionRepository(session)
    exclude = options.exclude
    settings = DetectSettings.of(SiteRepository(session).get(job.site_id).code_family, options)
    marks = MarkRepository(session).of_survey(job.survey_id)
    left_out = {*exclude.images, *(photo.name for photo in unreadable)}
    photos = []
    for photo in SurveyRepository(session).photos(job.survey_id):
        detection = None if photo.name in left_out else detections.get(settings.key(photo.sha256))
        if detection is not None:
            seen = with_marks(detection, marks.get(photo.name, ()))
            photos.append(SurveyPhoto(photo.name, photo.identity, _without(seen, exclude.codes)))
    return tuple(photos)


def _unused_marks(session: Session, job: Job, photos: tuple[SurveyPhoto, ...]) -> tuple[str, ...]:
    """What the surveyor should know of marks that made no target."""
    marks, exclude = MarkRepository(session).of_survey(job.survey_id), reading_options(job).exclude
    warnings = []
    for photo in photos:
        seen = {target.code for target in photo.detection.targets}
        for code in sorted({mark.code for mark in marks.get(photo.name, ())} - seen - set(exclude.codes)):
            warnings.append(
                f"Marks of target {code} in {photo.name} are not used: no detector saw it there, so {FEWEST_MARKS} "
                "dots that are not in one line must be marked."
            )
    return tuple(warnings)


def _without(detection: Detection, codes: tuple[int, ...]) -> Detection:
    return replace(detection, targets=tuple(target for target in detection.targets if target.code not in codes))


def _publication(material: _Material, result: SurveyResult, unreadable: tuple[Unreadable, ...]) -> Publication:
    device_id = material.survey.device_id
    origin = Origin(material.survey.survey_id, material.job.job_id, material.options.base_version)
    cameras = tuple(NewCamera(camera.identity, camera.calibrated, device_id) for camera in result.cameras)
    left_out = (PhotoResult(name=photo.name, reason=photo.reason) for photo in unreadable)
    photos = (*photo_results(result), *left_out)
    told = result.report.to_json()
    warnings = [*told["warnings"], *material.warnings]
    report = {**told, "warnings": warnings, "excluded": asdict(material.options.exclude)}
    if material.base is None:
        return Publication(result.target_map, origin, cameras, photos, report)
    extension = extend_map(material.base, result.target_map, material.options.exclude.codes)
    extended = {"base_version": origin.base_version, "added": list(extension.added), "moved": list(extension.moved)}
    return Publication(extension.target_map, origin, cameras, photos, {**report, "extension": extended})


def _publish(database: Database, material: _Material, publication: Publication) -> int:
    """Map, activation and the job's success in one transaction: a job that was cancelled publishes nothing."""
    site_id = material.site.site_id
    with database.writing() as session:
        maps = TargetMapRepository(session)
        version = maps.publish(site_id, publication)
        if material.options.activate:
            maps.activate(site_id, version)
        counts = {
            "targets": len(publication.target_map.targets),
            "photographs": len(publication.photos),
            "unoriented": sum(photo.site_from_cam is None for photo in publication.photos),
        }
        if not JobRepository(session).succeed(material.run, {"map_version": version, **counts}):
            raise Cancelled("the job was cancelled", job_id=material.run.job_id)
    return version
