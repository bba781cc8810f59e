"""What a survey is given, and the same as arrays: photographs ordered by camera, sightings fit for an adjustment."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from app.errors import NotLocated, SurveyFailed
from app.geometry.camera import CalibratedCamera, CameraIdentity
from app.geometry.observations import Detection
from app.geometry.print_batch import PrintBatch
from app.photogrammetry.bundle_problem import BundleProblem
from app.photogrammetry.camera_prior import camera_from_exif
from app.photogrammetry.planar_pose import PlanarPoseOptions, planar_poses
from app.photogrammetry.prints import PRINT_SIGMA, Prints
from app.photogrammetry.sightings import gather_sightings

Index = npt.NDArray[np.intp]

FEWEST_PHOTOS = 2
OVERLAP_ADVICE = (
    "photograph every plate from at least three places that stand well apart, and let each photograph share several "
    "plates with others"
)


@dataclass(frozen=True)
class SurveyPhoto:
    """One photograph of a survey: its name, its camera, what was seen in it."""

    name: str
    identity: CameraIdentity
    detection: Detection


@dataclass(frozen=True)
class PlateSpec:
    """The plates of a site: their code family, nominal module in metres, and batches whose check bars were measured."""

    code_family: str
    u_m: float
    batches: tuple[PrintBatch, ...] = ()


@dataclass(frozen=True)
class Unoriented:
    """A photograph without a pose, and why."""

    name: str
    reason: str


@dataclass(frozen=True)
class SurveyInput:
    """A survey as arrays.

    Attributes
    ----------
    problem : BundleProblem
        P photographs with known cameras and at least one usable target, ordered by camera; T targets.
    names : tuple of str
        Of the P photographs.
    codes : ndarray of shape (T,), int
    identities : tuple of CameraIdentity
        Of the C cameras.
    batch_names : tuple of str
        Of the print batches, the first one empty: targets on no list.
    refused : tuple of Unoriented
        Photographs that could not take part.
    """

    problem: BundleProblem
    names: tuple[str, ...]
    codes: Index
    identities: tuple[CameraIdentity, ...]
    batch_names: tuple[str, ...]
    refused: tuple[Unoriented, ...]


def read_survey(photos: Sequence[SurveyPhoto], plate: PlateSpec) -> SurveyInput:
    """The survey as arrays.

    Raises
    ------
    SurveyFailed
        Reason ``duplicate-names``, ``no-targets``, ``unknown-camera`` or ``too-few-photos``.
    """
    _check_names(photos)
    priors, strangers = _camera_priors(photos)
    empty = [Unoriented(photo.name, "no target was found in it") for photo in photos if not photo.detection.targets]
    usable = [photo for photo in photos if photo.identity.key in priors and photo.detection.targets]
    _check_enough(photos, empty, strangers, usable)
    keys = list(priors)
    ordered = sorted(usable, key=lambda photo: keys.index(photo.identity.key))
    sightings, codes = gather_sightings([photo.detection for photo in ordered])
    problem = BundleProblem(
        sightings,
        np.array([keys.index(photo.identity.key) for photo in ordered], dtype=np.intp),
        tuple(priors.values()),
        plate.u_m,
        _prints(codes, plate.batches),
    )
    identities = tuple(next(photo.identity for photo in ordered if photo.identity.key == key) for key in keys)
    names, batches = tuple(photo.name for photo in ordered), ("", *(batch.name for batch in plate.batches))
    return SurveyInput(_with_poses_only(problem), names, codes, identities, batches, (*empty, *strangers))


def _prints(codes: Index, batches: Sequence[PrintBatch]) -> Prints:
    """Batch 0 holds what is on no list; all are held as they were measured until control points say more."""
    batch = np.zeros(len(codes), dtype=np.intp)
    for number, one in enumerate(batches, start=1):
        batch[np.isin(codes, one.codes)] = number
    expected = np.array([(1.0, 1.0), *(one.scale_xy for one in batches)])
    sigma = np.array([PRINT_SIGMA, *(one.scale_sigma for one in batches)])
    every = np.ones(len(sigma), dtype=np.bool_)
    return Prints(batch, batch, expected, sigma, held=every, found=~every)


def _check_names(photos: Sequence[SurveyPhoto]) -> None:
    repeated = sorted(name for name, count in Counter(photo.name for photo in photos).items() if count > 1)
    if repeated:
        raise SurveyFailed(
            f"Photographs share the names {', '.join(repeated)}: give each photograph a name of its own.",
            reason="duplicate-names",
            photos=repeated,
        )


def _camera_priors(photos: Sequence[SurveyPhoto]) -> tuple[dict[str, CalibratedCamera], list[Unoriented]]:
    """Priors by camera key, keys ascending, of cameras that saw targets; photographs whose camera is unknown."""
    priors: dict[str, CalibratedCamera] = {}
    strangers: list[Unoriented] = []
    for photo in sorted(photos, key=lambda photo: photo.identity.key):
        if photo.detection.targets and photo.identity.key not in priors:
            try:
                priors[photo.identity.key] = camera_from_exif(photo.identity)
            except NotLocated as error:
                strangers.append(Unoriented(photo.name, error.detail))
    return priors, strangers


def _check_enough(
    photos: Sequence[SurveyPhoto],
    empty: Sequence[Unoriented],
    strangers: Sequence[Unoriented],
    usable: Sequence[SurveyPhoto],
) -> None:
    """A map takes targets that several photographs see, of cameras whose focal length is about known."""
    if len(photos) >= FEWEST_PHOTOS and len(empty) == len(photos):
        raise SurveyFailed(
            f"No target was found in any of the {len(photos)} photographs. Check that the plates belong to the site's "
            "code family and fill at least 30 px each, and photograph them from nearer and in better light.",
            reason="no-targets",
        )
    if strangers and not usable:
        raise SurveyFailed(strangers[0].reason, reason="unknown-camera", photos=[photo.name for photo in strangers])
    if len(usable) < FEWEST_PHOTOS:
        raise SurveyFailed(
            f"A target map takes at least {FEWEST_PHOTOS} photographs with targets, and {len(usable) or 'none'} can be "
            f"used: {OVERLAP_ADVICE}.",
            reason="too-few-photos",
            photos=[photo.name for photo in photos],
        )


def _with_poses_only(problem: BundleProblem) -> BundleProblem:
    """Without sightings that have no planar pose: fewer than four dots, or dots on one line, start nothing."""
    sightings = problem.sightings
    normalised = np.empty(sightings.dots_px.shape)
    camera = problem.camera_of_photo[sightings.photo]
    for index, prior in enumerate(problem.cameras):
        normalised[camera == index] = prior.camera.normalise(sightings.dots_px[camera == index])
    poses = planar_poses(problem.plane_m, normalised, sightings.measured, PlanarPoseOptions(refinement_steps=0))
    return problem.with_sightings(sightings.select(np.asarray(poses.exists.all(axis=-1))))
