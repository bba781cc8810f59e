"""What is known of a camera that no survey has calibrated: EXIF, the client's word, another unit of the same model.

Each source gives intrinsics with an honest covariance; an adjustment takes them as weighted unknowns and sharpens what
the photograph's geometry carries.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from app.errors import NotLocated
from app.geometry.camera import CalibratedCamera, Camera, CameraIdentity

Array = npt.NDArray[np.float64]

FILM_WIDTH_MM = 36.0  # the frame of 35 mm film is 36 mm x 24 mm (ISO 1007)
FILM_DIAGONAL_MM = float(np.hypot(36.0, 24.0))
SENSOR_DIAGONAL_PER_WIDTH = float(np.hypot(4.0, 3.0) / 4.0)  # phones' sensors are 4:3; other pictures are cut from them

CALIBRATE_ADVICE = "calibrate the camera by photographing the site, or send the camera's intrinsics with the snapshot"


@dataclass(frozen=True)
class CameraPriorOptions:
    """How far priors are trusted: standard deviations.

    Attributes
    ----------
    focal_35mm_range_mm : tuple of float
        35 mm equivalents outside are taken as nonsense: 8 mm is a fish-eye's, which Brown-Conrady does not describe.
    focal_35mm_step_mm : float
        EXIF writes the 35 mm equivalent in whole millimetres (Exif 2.32, tag 41989).
    exif_focal : float
        Of the focal length, relative, beside rounding and the choice of convention: focusing and the print on the
        box, of the order of 1 %.
    aspect : float
        Of fy / fx, relative: pixels are square to a part in a thousand.
    exif_centre, client_centre, model_centre : float
        Of the principal point, as a fraction of the longer side. Assembly and stabilised lenses move it by up to a
        percent; a client's word is better; between units of one model see Sanz-Ablanedo et al., Sensors 2010, 10(3).
    client_focal : float
        Of the focal length that ARCore or ARKit report, relative: a factory's figure without the focus of the moment.
    model_focal : float
        Of the focal length between units of one model, relative (pipeline.md, section 2: at least 0.5 %).
    unknown_distortion : tuple of float
        Of k1, k2, p1, p2, k3 when nothing is known: the range of published phone calibrations.
    client_distortion : tuple of float
        The same when the client gives coefficients.
    model_distortion : tuple of float
        The same between units of one model.
    """

    focal_35mm_range_mm: tuple[float, float] = (8.0, 1000.0)
    focal_35mm_step_mm: float = 1.0
    exif_focal: float = 0.01
    aspect: float = 0.001
    exif_centre: float = 0.01
    client_centre: float = 0.004
    model_centre: float = 0.003
    client_focal: float = 0.005
    model_focal: float = 0.005
    unknown_distortion: tuple[float, float, float, float, float] = (0.1, 0.3, 0.002, 0.002, 0.3)
    client_distortion: tuple[float, float, float, float, float] = (0.02, 0.06, 0.0005, 0.0005, 0.06)
    model_distortion: tuple[float, float, float, float, float] = (0.01, 0.03, 0.0003, 0.0003, 0.03)


@dataclass(frozen=True)
class _Sigmas:
    """Relative focal and aspect sigmas, principal point in px, distortion."""

    focal: float
    aspect: float
    centre_px: float
    distortion: tuple[float, float, float, float, float]


def camera_from_exif(identity: CameraIdentity, options: CameraPriorOptions | None = None) -> CalibratedCamera:
    """A camera known by its 35 mm equivalent focal length alone.

    Raises
    ------
    NotLocated
        Reason ``unknown-camera`` when EXIF gives no believable 35 mm equivalent.

    Notes
    -----
    Makers convert by the width of the picture, by its diagonal, or by the diagonal of the sensor it is cut from. The
    prior stands in their middle, and their scatter is in its sigma together with the rounding to whole millimetres.
    """
    options = options or CameraPriorOptions()
    focal_35mm = identity.focal_35mm
    least_mm, greatest_mm = options.focal_35mm_range_mm
    if focal_35mm is None or not least_mm <= focal_35mm <= greatest_mm:
        raise _unknown_camera(identity)
    conventions_px = _focal_conventions_px(identity, focal_35mm)
    focal_px = float(conventions_px.mean())
    rounding = options.focal_35mm_step_mm / np.sqrt(12.0) / focal_35mm  # sigma of a uniform step
    relative = float(np.linalg.norm([conventions_px.std() / focal_px, rounding, options.exif_focal]))
    long_px = max(identity.width_px, identity.height_px)
    sigmas = _Sigmas(relative, options.aspect, options.exif_centre * long_px, options.unknown_distortion)
    centre_px = [(identity.width_px - 1) / 2.0, (identity.height_px - 1) / 2.0]
    intrinsics = np.array([focal_px, focal_px, *centre_px, 0.0, 0.0, 0.0, 0.0, 0.0])
    camera = Camera(identity.width_px, identity.height_px, intrinsics)
    return CalibratedCamera(camera, _covariance(camera, sigmas), "exif")


def camera_from_client(
    camera: Camera,
    covariance: Array | None = None,
    distortion_known: bool = True,
    options: CameraPriorOptions | None = None,
) -> CalibratedCamera:
    """A camera as the client describes it (ARCore, ARKit, its own calibration).

    Parameters
    ----------
    camera : Camera
        For the size that the client's intrinsics belong to; zeros where the client names no distortion.
    covariance : ndarray of shape (9, 9), optional
        When the client knows it; otherwise the options' sigmas stand for it.
    distortion_known : bool
        False when the client gave no coefficients: none is not the same as zero.
    options : CameraPriorOptions, optional
    """
    options = options or CameraPriorOptions()
    if covariance is None:
        distortion = options.client_distortion if distortion_known else options.unknown_distortion
        centre_px = options.client_centre * max(camera.width_px, camera.height_px)
        covariance = _covariance(camera, _Sigmas(options.client_focal, options.aspect, centre_px, distortion))
    return CalibratedCamera(camera, covariance, "client")


def camera_of_model(calibrated: CalibratedCamera, options: CameraPriorOptions | None = None) -> CalibratedCamera:
    """What the calibration of one unit says of another unit of the same model: the units' scatter comes on top."""
    options = options or CameraPriorOptions()
    camera = calibrated.camera
    centre_px = options.model_centre * max(camera.width_px, camera.height_px)
    scatter = _covariance(camera, _Sigmas(options.model_focal, options.aspect, centre_px, options.model_distortion))
    return replace(calibrated, covariance=calibrated.covariance + scatter, source="model")


def _focal_conventions_px(identity: CameraIdentity, focal_35mm: float) -> Array:
    """Focal lengths in px that a 35 mm equivalent may mean, shape (3,)."""
    long_px = max(identity.width_px, identity.height_px)
    diagonal_px = float(np.hypot(identity.width_px, identity.height_px))
    return focal_35mm * np.array(
        [
            long_px / FILM_WIDTH_MM,
            diagonal_px / FILM_DIAGONAL_MM,
            SENSOR_DIAGONAL_PER_WIDTH * long_px / FILM_DIAGONAL_MM,
        ]
    )


def _covariance(camera: Camera, sigmas: _Sigmas) -> Array:
    """Covariance of the intrinsics, shape (9, 9): fx and fy share the focal length's error."""
    fx, fy = camera.intrinsics[:2]
    covariance = np.diag([0.0, 0.0, sigmas.centre_px**2, sigmas.centre_px**2, *np.square(sigmas.distortion)])
    covariance[:2, :2] = sigmas.focal**2 * np.outer([fx, fy], [fx, fy])
    # Half of the aspect's error to each, opposite in sign, leaves their mean alone.
    covariance[:2, :2] += (sigmas.aspect / 2.0) ** 2 * np.outer([fx, -fy], [fx, -fy])
    return covariance


def _unknown_camera(identity: CameraIdentity) -> NotLocated:
    name = f"{identity.make} {identity.model}".strip() or "a camera that its photograph does not name"
    return NotLocated(
        f"The intrinsics of {name} at {identity.width_px} x {identity.height_px} px are unknown, and EXIF tells no "
        f"usable 35 mm focal length: {CALIBRATE_ADVICE}.",
        reason="unknown-camera",
        advice=CALIBRATE_ADVICE,
        seen={"camera": identity.key},
    )
