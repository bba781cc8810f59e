"""What became of each photograph of a survey, as it is stored and reported."""

from __future__ import annotations

from app.photogrammetry.survey import SurveyResult
from app.storage.records import PhotoResult


def photo_results(survey: SurveyResult) -> tuple[PhotoResult, ...]:
    """Oriented photographs with their poses, then the others with their reasons."""
    oriented = [
        PhotoResult(
            name=photo.name,
            camera_key=photo.camera_key,
            site_from_cam=photo.site_from_cam,
            covariance=photo.covariance,
            rms_px=photo.rms_px,
            target_count=photo.target_count,
            codes=photo.codes,
        )
        for photo in survey.photos
    ]
    return (*oriented, *(PhotoResult(name=name, reason=reason) for name, reason in survey.unoriented))
