"""The story of a calibration: photographs of one camera -> resect each -> adjust together -> judge what they carry."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import partial

import numpy as np
from threadpoolctl import threadpool_limits

from app.geometry.camera import CalibratedCamera, CameraIdentity
from app.geometry.target_map import TargetMap
from app.photogrammetry.calibration.adjust import AdjustedCamera, adjust_camera
from app.photogrammetry.calibration.carried import CarriedOptions, check_carried, not_carried
from app.photogrammetry.calibration.one_camera import LeftOutPhoto, photos_of_one_camera
from app.photogrammetry.calibration.orient import (
    Oriented,
    OrientOptions,
    RefusedTarget,
    orient_at_best,
    orient_with,
)
from app.photogrammetry.self_calibration import CameraScatter
from app.photogrammetry.survey_input import SurveyPhoto

__all__ = [
    "CalibratedPhoto",
    "Calibration",
    "CalibrationOptions",
    "LeftOutPhoto",
    "RefusedTarget",
    "SurveyPhoto",
    "calibrate_camera",
]

CalibrationProgress = Callable[[str, int, int], None]


@dataclass(frozen=True)
class CalibrationOptions:
    """The decisions of each stage."""

    orient: OrientOptions = field(default_factory=OrientOptions)
    carried: CarriedOptions = field(default_factory=CarriedOptions)


@dataclass(frozen=True)
class CalibratedPhoto:
    """A photograph that took part.

    Attributes
    ----------
    name : str
    targets : int
        Of the map, that were used in it.
    rms_residual_px : float
        Per coordinate.
    """

    name: str
    targets: int
    rms_residual_px: float


@dataclass(frozen=True)
class Calibration:
    """A calibrated camera and what it was calibrated from.

    Attributes
    ----------
    identity : CameraIdentity
    calibrated : CalibratedCamera
        Source ``calibration``; covariance: posterior plus the scatter between photographs.
    scatter : CameraScatter
        How far a photograph's own focal length and principal point are off the camera's: autofocus, stabilised lens.
    photos : tuple of CalibratedPhoto
        Those that took part.
    left_out : tuple of LeftOutPhoto
        The others, each with its reason.
    targets : int
        That took part.
    refused_targets : tuple of RefusedTarget
        Targets that do not stand where the map says, by photographs.
    not_carried : tuple of str
        Intrinsics that the photographs say little about: they are hardly better known than before.
    rms_residual_px : float
        Per coordinate.
    """

    identity: CameraIdentity
    calibrated: CalibratedCamera
    scatter: CameraScatter
    photos: tuple[CalibratedPhoto, ...]
    left_out: tuple[LeftOutPhoto, ...]
    targets: int
    refused_targets: tuple[RefusedTarget, ...]
    not_carried: tuple[str, ...]
    rms_residual_px: float


def calibrate_camera(
    photos: Sequence[SurveyPhoto],
    target_map: TargetMap,
    options: CalibrationOptions | None = None,
    progress: CalibrationProgress | None = None,
) -> Calibration:
    """Intrinsics of a camera from photographs of a mapped site.

    Parameters
    ----------
    photos : sequence of SurveyPhoto
        Names unique; those of another camera, size or zoom than most are left out and named.
    target_map : TargetMap
        Its targets are weighted by their own covariance. The datum does not matter: a small similarity of the map
        moves the photographs with it and leaves the camera alone.
    options : CalibrationOptions, optional
    progress : callable, optional
        Told the stage (``orient``, ``adjust``) with what is done of how much; may raise ``Cancelled``.

    Raises
    ------
    CalibrationFailed
        ``fields['reason']``: ``no-targets``, ``several-cameras``, ``too-few-photos``, ``focal-not-carried``,
        ``focal-scatters`` or ``centre-not-carried``; the text says which photographs to add.
    """
    options, tell = options or CalibrationOptions(), progress or _silent
    chosen, strangers = photos_of_one_camera(photos, target_map)
    with threadpool_limits(limits=1, user_api="blas"):  # products of small matrices
        first = orient_at_best(chosen, target_map, options.orient, partial(tell, "orient"))
        tell("adjust", 0, 1)
        rough = adjust_camera(first, target_map)
        # Held against a camera that is known, what was moved and what is zoomed stands out.
        oriented = orient_with(chosen, target_map, rough.known_at_most(options.orient), options.orient)
        final = adjust_camera(replace(oriented, prior=first.prior), target_map)
    check_carried(final, options.carried)
    tell("adjust", 1, 1)
    return _calibration(chosen[0].identity, oriented, strangers, final)


def _calibration(
    identity: CameraIdentity, oriented: Oriented, strangers: tuple[LeftOutPhoto, ...], final: AdjustedCamera
) -> Calibration:
    return Calibration(
        identity=identity,
        calibrated=final.found.calibrated,
        scatter=final.found.scatter,
        photos=_photos(oriented, final),
        left_out=(*strangers, *oriented.left_out),
        targets=final.problem.sightings.target_count,
        refused_targets=oriented.refused_targets,
        not_carried=not_carried(final),
        rms_residual_px=final.rms_residual_px,
    )


def _photos(oriented: Oriented, final: AdjustedCamera) -> tuple[CalibratedPhoto, ...]:
    sightings = final.problem.sightings
    targets = np.bincount(sightings.photo, minlength=sightings.photo_count)
    return tuple(
        CalibratedPhoto(photo.name, int(count), float(rms_px))
        for photo, count, rms_px in zip(oriented.photos, targets, final.photo_rms_px, strict=True)
    )


def _silent(stage: str, done: int, total: int) -> None:
    """Nobody wants to know."""
