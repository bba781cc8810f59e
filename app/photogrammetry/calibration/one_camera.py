"""Which photographs are of one camera at one setting: a calibration is of that, the others are named and left out."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, replace

from app.errors import CalibrationFailed
from app.geometry.camera import CameraIdentity
from app.geometry.observations import Detection
from app.geometry.target_map import TargetMap
from app.photogrammetry.survey_input import SurveyPhoto

MAJORITY = 0.5


@dataclass(frozen=True)
class LeftOutPhoto:
    """A photograph that took no part: its name, a stable reason, and what to do, for a person."""

    name: str
    reason: str
    detail: str


def photos_of_one_camera(
    photos: Sequence[SurveyPhoto], target_map: TargetMap
) -> tuple[tuple[SurveyPhoto, ...], tuple[LeftOutPhoto, ...]]:
    """The photographs of the camera that took most of them, with the map's targets alone; and the others.

    Raises
    ------
    CalibrationFailed
        Reason ``no-targets`` when none shows a mapped target, ``several-cameras`` when no camera took most of them.
    """
    mapped = [replace(photo, detection=_in_map(photo.detection, target_map)) for photo in photos]
    seeing = [photo for photo in mapped if photo.detection.targets]
    if not seeing:
        raise CalibrationFailed(
            f"None of the {len(photos)} photographs shows a target of the site's map. Photograph its targets from "
            "nearer and in good light, and check that this is the right site.",
            reason="no-targets",
            photos=[photo.name for photo in photos],
        )
    key = _most_frequent(seeing)
    empty = tuple(
        LeftOutPhoto(photo.name, "no-targets", "shows no target of the site's map")
        for photo in mapped
        if not photo.detection.targets
    )
    identity = next(photo.identity for photo in seeing if photo.identity.key == key)
    strangers = tuple(_stranger(photo, identity) for photo in seeing if photo.identity.key != key)
    return tuple(photo for photo in seeing if photo.identity.key == key), (*empty, *strangers)


def _in_map(detection: Detection, target_map: TargetMap) -> Detection:
    known = tuple(target for target in detection.targets if target.code in target_map.by_code)
    return replace(detection, targets=known)


def _most_frequent(photos: Sequence[SurveyPhoto]) -> str:
    counts = Counter(photo.identity.key for photo in photos)
    key, count = counts.most_common(1)[0]
    if count <= MAJORITY * len(photos):
        raise CalibrationFailed(
            f"The photographs are of {len(counts)} cameras, sizes or zooms, and none of them took most: calibrate one "
            "camera at one setting at a time.",
            reason="several-cameras",
            cameras=dict(counts),
        )
    return key


def _stranger(photo: SurveyPhoto, most: CameraIdentity) -> LeftOutPhoto:
    """Why a photograph is of another camera than most."""
    own = photo.identity
    if (own.make, own.model) != (most.make, most.model):
        name, other = (f"{one.make} {one.model}".strip() or "an unnamed camera" for one in (own, most))
        return LeftOutPhoto(photo.name, "other-camera", f"is of {name}, the others of {other}")
    if (own.width_px, own.height_px) != (most.width_px, most.height_px):
        size = f"{own.width_px} x {own.height_px} px"
        detail = f"has {size}, the others {most.width_px} x {most.height_px} px: photograph at one size, unturned"
        return LeftOutPhoto(photo.name, "other-size", detail)
    return LeftOutPhoto(photo.name, "other-zoom", "was taken with another lens or zoom than the others, says its EXIF")
