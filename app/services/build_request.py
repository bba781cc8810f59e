"""A build is asked for: everything that can be seen to be wrong is said at once, the rest becomes a job."""

from __future__ import annotations

import logging
from collections.abc import Iterable

from sqlalchemy.orm import Session

from app.errors import Conflict, InvalidInput
from app.services.build_options import BuildOptions, Exclusion
from app.services.control_points import check_datum
from app.services.job_kinds import BUILD
from app.storage.jobs import Job, JobRepository
from app.storage.records import Survey
from app.storage.sites import SiteRepository
from app.storage.surveys import SurveyRepository
from app.storage.target_maps import TargetMapRepository
from app.targets.family import family_by_name
from app.vision.detectors import choose_detector

log = logging.getLogger(__name__)

LEAST_PHOTOS = 2  # a target's place takes rays from several photographs


def request_build(session: Session, survey_id: str, options: BuildOptions) -> Job:
    """Put a build of a survey in the queue: a worker finds it there once the transaction is committed.

    Raises
    ------
    NotFound
        When the survey or the base version does not exist.
    Conflict
        When the survey has too few photographs.
    InvalidInput
        When something is excluded that is not there, too few control points are left, or the detector cannot be as
        strict as that.
    """
    choose_detector(options.detector, options.strictness)
    survey = SurveyRepository(session).get(survey_id)
    _check_photos(session, survey, options.exclude)
    _check_site(session, survey, options)
    job = JobRepository(session).add(BUILD, survey.site_id, survey_id, options.to_json())
    # Where the request's lines and those of the workers meet.
    log.info("a build is asked for", extra={"job_id": job.job_id, "survey_id": survey_id})
    return job


def _check_photos(session: Session, survey: Survey, exclude: Exclusion) -> None:
    names = {photo.name for photo in SurveyRepository(session).photos(survey.survey_id)}
    _check_known("images", exclude.images, names)
    left = len(names.difference(exclude.images))
    if left < LEAST_PHOTOS:
        raise Conflict(
            f"the survey has {left} photographs to build from and needs {LEAST_PHOTOS} at least; "
            f"PUT /surveys/{survey.survey_id}/images/{{filename}} adds one",
            survey_id=survey.survey_id,
            photographs=left,
        )


def _check_site(session: Session, survey: Survey, options: BuildOptions) -> None:
    sites = SiteRepository(session)
    family = family_by_name(sites.get(survey.site_id).code_family)
    unknown_codes = [code for code in options.exclude.codes if not family.contains(code)]
    if unknown_codes:
        raise InvalidInput(
            f"exclude.codes: {unknown_codes} are no codes of family {family.name}",
            field="exclude.codes",
            codes=unknown_codes,
        )
    points = sites.control_points(survey.site_id)
    _check_known("control_points", options.exclude.control_points, {point.name for point in points})
    if options.base_version is None:
        check_datum(options.exclude.points_left(points))
    else:
        TargetMapRepository(session).version(survey.site_id, options.base_version)


def _check_known(field: str, names: Iterable[str], known: set[str]) -> None:
    unknown = sorted(set(names) - known)
    if unknown:
        raise InvalidInput(
            f"exclude.{field}: there is no {', '.join(unknown[:5])}; write the names as they were given",
            field=f"exclude.{field}",
            unknown=unknown,
        )
