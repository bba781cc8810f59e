"""Orient the photographs of a calibration in the map, each by itself, under what is known of the camera so far.

Each resection has the intrinsics as weighted unknowns, refuses targets that were moved, and tells what focal length the
photograph by itself believes in: by that a photograph of another zoom is found.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
import numpy.typing as npt

from app.errors import NotLocated
from app.geometry.camera import CalibratedCamera, CameraIdentity
from app.geometry.target_map import TargetMap
from app.photogrammetry.calibration.one_camera import LeftOutPhoto
from app.photogrammetry.camera_prior import CameraPriorOptions, camera_from_exif
from app.photogrammetry.resection import Resection, ResectionOptions, resect
from app.photogrammetry.survey_input import SurveyPhoto

Array = npt.NDArray[np.float64]


@dataclass(frozen=True)
class OrientOptions:
    """How photographs are oriented and which of them are taken for the same zoom.

    Attributes
    ----------
    focal_35mm_ladder_mm : tuple of float
        35 mm equivalents to try when EXIF tells none, or none that fits: phones from the ultra-wide to the long lens,
        each a quarter beyond the last.
    ladder_sigma : float
        Standard deviation of a rung, relative: half the way to the next.
    enough_share : float
        Of the photographs that EXIF's focal length must orient to be believed.
    zoom_sigmas, zoom_share : float
        A photograph whose own focal length is off the others' by more than both is of another zoom. Focusing from 0.5 m
        to far moves it by 1 to 3 % (the extension is f^2 over the distance).
    moved_share : float
        A target that so great a share of its photographs refuse takes no part.
    moved_photos : int
        Of at least so many.
    breathing : float
        Scatter of the focal length between photographs, relative, that the second orientation allows for before any
        has been estimated.
    resection : ResectionOptions
    """

    focal_35mm_ladder_mm: tuple[float, ...] = (13.0, 16.0, 20.0, 25.0, 31.0, 39.0, 49.0, 61.0, 76.0)
    ladder_sigma: float = 0.12
    enough_share: float = 0.5
    zoom_sigmas: float = 4.0
    zoom_share: float = 0.03
    moved_share: float = 0.5
    moved_photos: int = 2
    breathing: float = 0.01
    resection: ResectionOptions = field(default_factory=ResectionOptions)


@dataclass(frozen=True)
class RefusedTarget:
    """A target that photographs say was moved since the map was made, or misread.

    Attributes
    ----------
    code : int
    refused, seen : int
        Photographs that refuse it, and that see it.
    left_out : bool
        Whether it took no part at all.
    """

    code: int
    refused: int
    seen: int
    left_out: bool


@dataclass(frozen=True)
class Oriented:
    """Photographs with poses.

    Attributes
    ----------
    photos : tuple of SurveyPhoto
        With those of their targets that agree.
    resections : tuple of Resection
    left_out : tuple of LeftOutPhoto
    refused_targets : tuple of RefusedTarget
    prior : CalibratedCamera
        What was known of the camera before.
    """

    photos: tuple[SurveyPhoto, ...]
    resections: tuple[Resection, ...]
    left_out: tuple[LeftOutPhoto, ...]
    refused_targets: tuple[RefusedTarget, ...]
    prior: CalibratedCamera


def orient_at_best(
    photos: Sequence[SurveyPhoto],
    target_map: TargetMap,
    options: OrientOptions,
    tell: Callable[[int, int], None],
) -> Oriented:
    """Orient under EXIF's focal length, or under that rung of a ladder which orients most photographs."""
    rungs = [prior_of(photos[0].identity, focal_mm, options) for focal_mm in options.focal_35mm_ladder_mm]
    try:
        cameras = [camera_from_exif(photos[0].identity), *rungs]
        sure = True
    except NotLocated:
        cameras, sure = rungs, False
    best: Oriented | None = None
    for done, camera in enumerate(cameras):
        tell(done, len(cameras))
        found = orient_with(photos, target_map, camera, options)
        if best is None or _rank(found) > _rank(best):
            best = found
        if sure and done == 0 and len(found.photos) >= options.enough_share * len(photos):
            break
    assert best is not None
    tell(len(cameras), len(cameras))
    return best


def prior_of(identity: CameraIdentity, focal_35mm: float, options: OrientOptions) -> CalibratedCamera:
    """A camera of which nothing is known, supposed to have about a focal length."""
    wide = replace(CameraPriorOptions(), exif_focal=options.ladder_sigma)
    return camera_from_exif(replace(identity, focal_35mm=focal_35mm), wide)


def orient_with(
    photos: Sequence[SurveyPhoto], target_map: TargetMap, camera: CalibratedCamera, options: OrientOptions
) -> Oriented:
    """Orient each photograph under a camera; what does not fit is left out and named."""
    found: list[tuple[SurveyPhoto, Resection]] = []
    left_out: list[LeftOutPhoto] = []
    for photo in photos:
        try:
            found.append((photo, resect(photo.detection.targets, target_map, camera, options.resection)))
        except NotLocated as refusal:
            left_out.append(LeftOutPhoto(photo.name, str(refusal.fields["reason"]), refusal.detail))
    zoomed = _other_zooms([resection.camera for _, resection in found], options)
    left_out += [_zoomed(photo, ratio) for (photo, _), ratio in zip(found, zoomed, strict=True) if ratio is not None]
    kept = [pair for pair, ratio in zip(found, zoomed, strict=True) if ratio is None]
    refused = _refused_targets([resection for _, resection in kept], options)
    gone = {target.code for target in refused if target.left_out}
    agreeing = [(_agreeing(photo, resection, gone), resection) for photo, resection in kept]
    left = [(photo, resection) for photo, resection in agreeing if photo.detection.targets]
    left_out += [
        LeftOutPhoto(photo.name, "moved-targets", "shows only targets that were moved since the map was made")
        for photo, _ in agreeing
        if not photo.detection.targets
    ]
    return Oriented(
        tuple(photo for photo, _ in left), tuple(resection for _, resection in left), tuple(left_out), refused, camera
    )


def _rank(oriented: Oriented) -> tuple[int, float]:
    """More photographs are better; then smaller residuals, in units of what they should be."""
    if not oriented.resections:
        return 0, 0.0
    return len(oriented.photos), -float(np.median([resection.sigma0 for resection in oriented.resections]))


def _other_zooms(cameras: Sequence[CalibratedCamera], options: OrientOptions) -> list[float | None]:
    """For each photograph its focal length over that of most, where it is another; None where it is not."""
    if not cameras:
        return []
    log_focal = np.log([camera.camera.fx_px for camera in cameras])
    sigmas = np.array([np.sqrt(camera.covariance[0, 0]) / camera.camera.fx_px for camera in cameras])
    off = log_focal - _weighted_median(log_focal, 1.0 / sigmas**2)
    other = np.abs(off) > np.maximum(options.zoom_sigmas * sigmas, options.zoom_share)
    return [float(np.exp(value)) if is_other else None for value, is_other in zip(off, other, strict=True)]


def _weighted_median(values: Array, weights: Array) -> float:
    order = np.argsort(values)
    share = np.cumsum(weights[order]) / weights.sum()
    return float(values[order][np.searchsorted(share, 0.5)])


def _zoomed(photo: SurveyPhoto, ratio: float) -> LeftOutPhoto:
    detail = f"has {ratio:.2f} times the focal length of the others: it is of another lens or zoom, or was cropped"
    return LeftOutPhoto(photo.name, "other-zoom", detail)


def _refused_targets(resections: Sequence[Resection], options: OrientOptions) -> tuple[RefusedTarget, ...]:
    seen = Counter(target.code for resection in resections for target in resection.targets)
    refused = Counter(target.code for resection in resections for target in resection.targets if not target.used)
    return tuple(
        RefusedTarget(
            code,
            count,
            seen[code],
            count >= options.moved_photos and count > options.moved_share * seen[code],
        )
        for code, count in sorted(refused.items())
    )


def _agreeing(photo: SurveyPhoto, resection: Resection, gone: set[int]) -> SurveyPhoto:
    """The photograph with those of its targets that were used and are not moved."""
    used = {target.code for target in resection.targets if target.used} - gone
    kept = tuple(target for target in photo.detection.targets if target.code in used)
    return replace(photo, detection=replace(photo.detection, targets=kept))
