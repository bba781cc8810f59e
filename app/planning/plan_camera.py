"""The camera of a plan: a phone by its focal length or angle of view, and how well it will be known."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from app.geometry.camera import CalibratedCamera, Camera, CameraIdentity
from app.photogrammetry.camera_prior import camera_from_client, camera_from_exif, camera_of_model
from app.planning.plan_fields import Field
from app.planning.survey_plan import phone_camera

Array = npt.NDArray[np.float64]

CAMERA_FIELDS = ("width_px", "height_px", "focal_px", "hfov_deg", "focal_35mm", "centre_px", "dist", "known_from")
SOURCES = ("survey", "calibration", "client", "model", "exif")
DISTORTION_COUNT = 5
MOST_PX = 20_000
FILM_WIDTH_MM = 36.0  # of the 35 mm film that equivalent focal lengths refer to
DEFAULT_SIZE_PX = (1920, 1080)


@dataclass(frozen=True)
class SurveyedCameraOptions:
    """How well a survey of some fifty photographs knows its camera: standard deviations.

    Attributes
    ----------
    focal_share : float
        Of the focal length, relative: 0.8 px of 1,400, the scatter between photographs included.
    aspect : float
        Of fy / fx, relative.
    centre_share : float
        Of the principal point, as a share of the longer side: 0.6 px of 1,920.
    distortion : tuple of float
        Of k1, k2, p1, p2, k3.
    """

    focal_share: float = 6e-4
    aspect: float = 1e-4
    centre_share: float = 3e-4
    distortion: tuple[float, float, float, float, float] = (2e-3, 4e-3, 1e-4, 1e-4, 3e-3)


def read_camera(field: Field) -> CalibratedCamera:
    """The object ``camera``; what it leaves out is a typical phone's.

    Raises
    ------
    InvalidInput
        Naming line and field.
    """
    members = field.members(*CAMERA_FIELDS)
    width_px = field.needed(members, "width_px").integer(1, MOST_PX)
    height_px = field.needed(members, "height_px").integer(1, MOST_PX)
    given = [name for name in ("focal_px", "hfov_deg", "focal_35mm") if name in members]
    if len(given) > 1:
        raise field.error(f"say one of {', '.join(given)}")
    typical = phone_camera(width_px, height_px)
    focal_px = _focal_px(members[given[0]], given[0], width_px, height_px) if given else typical.fx_px
    centre_px = (
        members["centre_px"].vector(2) if "centre_px" in members else np.array([width_px - 1, height_px - 1]) / 2
    )
    distortion = members["dist"].vector(4, DISTORTION_COUNT) if "dist" in members else np.zeros(DISTORTION_COUNT)
    distortion = np.append(distortion, np.zeros(DISTORTION_COUNT - len(distortion)))
    camera = Camera(width_px, height_px, np.array([focal_px, focal_px, *centre_px, *distortion]))
    return known_from(camera, members["known_from"].one_of(SOURCES) if "known_from" in members else "survey")


def default_camera() -> CalibratedCamera:
    """A typical phone's video frame, known from the survey."""
    return known_from(phone_camera(*DEFAULT_SIZE_PX), "survey")


def known_from(camera: Camera, source: str, options: SurveyedCameraOptions | None = None) -> CalibratedCamera:
    """A camera with the uncertainty that the source of its intrinsics leaves.

    Parameters
    ----------
    camera : Camera
    source : str
        ``survey``, ``calibration``, ``client``, ``model`` or ``exif``.
    options : SurveyedCameraOptions, optional
        For a survey or a calibration.

    Raises
    ------
    ValueError
        For any other source.
    """
    surveyed = CalibratedCamera(camera, _surveyed_covariance(camera, options or SurveyedCameraOptions()), "survey")
    if source in ("survey", "calibration"):
        return surveyed
    if source == "model":
        return camera_of_model(surveyed)
    if source == "client":
        return camera_from_client(camera)
    if source == "exif":
        long_px = max(camera.width_px, camera.height_px)
        focal_35mm = camera.fx_px / long_px * FILM_WIDTH_MM
        identity = CameraIdentity("", "", camera.width_px, camera.height_px, focal_35mm=focal_35mm)
        return CalibratedCamera(camera, camera_from_exif(identity).covariance, "exif")
    raise ValueError(f"{source!r} is none of {', '.join(SOURCES)}")


def _focal_px(field: Field, name: str, width_px: int, height_px: int) -> float:
    if name == "focal_px":
        return field.positive()
    if name == "focal_35mm":
        return field.positive() / FILM_WIDTH_MM * max(width_px, height_px)
    half_rad = np.radians(field.number(1.0, 179.0)) / 2
    return float(width_px / 2 / np.tan(half_rad))


def _surveyed_covariance(camera: Camera, options: SurveyedCameraOptions) -> Array:
    focal_px = camera.intrinsics[:2]
    centre_px = options.centre_share * max(camera.width_px, camera.height_px)
    covariance = np.diag([0.0, 0.0, centre_px**2, centre_px**2, *np.square(options.distortion)])
    covariance[:2, :2] = options.focal_share**2 * np.outer(focal_px, focal_px)
    covariance[:2, :2] += np.diag((options.aspect * focal_px) ** 2)
    return covariance
