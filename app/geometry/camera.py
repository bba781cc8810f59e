"""A camera's interior orientation (intrinsics) and lens distortion: Brown-Conrady as OpenCV writes it.

Camera frame: x right, y down, z forward. Pixel (0, 0) is the centre of the top-left pixel.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
import numpy.typing as npt

from app.geometry.readout import Readout

Array = npt.NDArray[np.float64]

INTRINSIC_NAMES = ("fx", "fy", "cx", "cy", "k1", "k2", "p1", "p2", "k3")
INTRINSIC_COUNT = len(INTRINSIC_NAMES)

UNDISTORT_STEPS = 12  # fixed-point steps; each gains a digit or more for the distortion of phones

CameraSource = Literal["survey", "calibration", "client", "exif", "model"]


@dataclass(frozen=True)
class CameraIdentity:
    """What tells one camera from another: a photograph's make, model, size and lens or zoom, as EXIF tells them.

    Attributes
    ----------
    make, model : str
        Empty when the photograph says nothing.
    width_px, height_px : int
        Size of the pixels as stored (EXIF orientation never applied).
    focal_mm, focal_35mm : float or None
        Focal length and its 35 mm equivalent.
    lens : str
        Lens name, empty when unknown.
    zoom : float
        Digital zoom ratio, 1 when unknown.
    """

    make: str
    model: str
    width_px: int
    height_px: int
    focal_mm: float | None = None
    focal_35mm: float | None = None
    lens: str = ""
    zoom: float = 1.0

    @property
    def key(self) -> str:
        """One line that is equal for photographs of one camera at one setting."""
        focal = "" if self.focal_mm is None else f"{self.focal_mm:.2f}mm"
        focal_35 = "" if self.focal_35mm is None else f"{self.focal_35mm:.0f}mm35"
        parts = [self.make.strip(), self.model.strip(), f"{self.width_px}x{self.height_px}", focal, focal_35, self.lens]
        return "|".join([*parts, f"zoom{self.zoom:g}"])


@dataclass(frozen=True)
class Camera:
    """Intrinsics for one image size.

    Attributes
    ----------
    width_px, height_px : int
        Image size.
    intrinsics : ndarray of shape (9,)
        fx, fy, cx, cy in px, then k1, k2, p1, p2, k3 (OpenCV's order).
    """

    width_px: int
    height_px: int
    intrinsics: Array

    def __post_init__(self) -> None:
        if self.intrinsics.shape != (INTRINSIC_COUNT,) or not np.isfinite(self.intrinsics).all():
            raise ValueError("a camera takes nine finite intrinsics: fx, fy, cx, cy, k1, k2, p1, p2, k3")
        if self.width_px < 1 or self.height_px < 1 or self.intrinsics[:2].min() <= 0:
            raise ValueError("image size and focal lengths must be positive")

    @property
    def fx_px(self) -> float:
        """Focal length along x, px."""
        return float(self.intrinsics[0])

    def with_intrinsics(self, intrinsics: Array) -> Camera:
        """The same image size with other intrinsics."""
        return replace(self, intrinsics=np.asarray(intrinsics, dtype=np.float64))

    def project(self, points_cam_m: Array) -> Array:
        """Image points, shape (..., 2), px, of points in the camera frame, shape (..., 3), z > 0."""
        x, y = points_cam_m[..., 0] / points_cam_m[..., 2], points_cam_m[..., 1] / points_cam_m[..., 2]
        fx, fy, cx, cy, k1, k2, p1, p2, k3 = self.intrinsics
        r2 = x * x + y * y
        radial = 1.0 + r2 * (k1 + r2 * (k2 + r2 * k3))
        u = fx * (x * radial + 2.0 * p1 * x * y + p2 * (r2 + 2.0 * x * x)) + cx
        v = fy * (y * radial + p1 * (r2 + 2.0 * y * y) + 2.0 * p2 * x * y) + cy
        return np.stack([u, v], axis=-1)

    def project_with_jacobians(self, points_cam_m: Array) -> tuple[Array, Array, Array]:
        """Image points and their derivatives.

        Parameters
        ----------
        points_cam_m : ndarray of shape (..., 3)
            Points in front of the camera.

        Returns
        -------
        image_px : ndarray of shape (..., 2)
        by_point : ndarray of shape (..., 2, 3)
            Derivative by the point, px per m.
        by_intrinsics : ndarray of shape (..., 2, 9)
            Derivative by fx, fy, cx, cy, k1, k2, p1, p2, k3.
        """
        inverse_z = 1.0 / points_cam_m[..., 2]
        x, y = points_cam_m[..., 0] * inverse_z, points_cam_m[..., 1] * inverse_z
        fx, fy, cx, cy, k1, k2, p1, p2, k3 = self.intrinsics
        x2, y2, xy = x * x, y * y, x * y
        r2 = x2 + y2
        radial = 1.0 + r2 * (k1 + r2 * (k2 + r2 * k3))
        radial_by_r2 = k1 + r2 * (2.0 * k2 + 3.0 * r2 * k3)
        xd = x * radial + 2.0 * p1 * xy + p2 * (r2 + 2.0 * x2)
        yd = y * radial + p1 * (r2 + 2.0 * y2) + 2.0 * p2 * xy

        xd_x = fx * (radial + 2.0 * x2 * radial_by_r2 + 2.0 * p1 * y + 6.0 * p2 * x)
        xd_y = fx * (2.0 * xy * radial_by_r2 + 2.0 * p1 * x + 2.0 * p2 * y)
        yd_x = fy * (2.0 * xy * radial_by_r2 + 2.0 * p1 * x + 2.0 * p2 * y)
        yd_y = fy * (radial + 2.0 * y2 * radial_by_r2 + 6.0 * p1 * y + 2.0 * p2 * x)
        by_point = np.empty((*x.shape, 2, 3))
        by_point[..., 0, 0], by_point[..., 0, 1] = xd_x * inverse_z, xd_y * inverse_z
        by_point[..., 1, 0], by_point[..., 1, 1] = yd_x * inverse_z, yd_y * inverse_z
        by_point[..., 0, 2] = -(xd_x * x + xd_y * y) * inverse_z
        by_point[..., 1, 2] = -(yd_x * x + yd_y * y) * inverse_z

        by_intrinsics = np.zeros((*x.shape, 2, INTRINSIC_COUNT))
        by_intrinsics[..., 0, 0], by_intrinsics[..., 1, 1] = xd, yd
        by_intrinsics[..., 0, 2] = by_intrinsics[..., 1, 3] = 1.0
        r4 = r2 * r2
        for column, power in ((4, r2), (5, r4), (8, r4 * r2)):
            by_intrinsics[..., 0, column], by_intrinsics[..., 1, column] = fx * x * power, fy * y * power
        by_intrinsics[..., 0, 6], by_intrinsics[..., 1, 6] = fx * 2.0 * xy, fy * (r2 + 2.0 * y2)
        by_intrinsics[..., 0, 7], by_intrinsics[..., 1, 7] = fx * (r2 + 2.0 * x2), fy * 2.0 * xy
        return np.stack([xd * fx + cx, yd * fy + cy], axis=-1), by_point, by_intrinsics

    def normalise(self, image_px: Array) -> Array:
        """Undistorted image-plane coordinates (x / z, y / z), shape (..., 2), of image points in px."""
        fx, fy, cx, cy, k1, k2, p1, p2, k3 = self.intrinsics
        xd, yd = (image_px[..., 0] - cx) / fx, (image_px[..., 1] - cy) / fy
        x, y = xd, yd
        for _ in range(UNDISTORT_STEPS):
            r2 = x * x + y * y
            radial = 1.0 + r2 * (k1 + r2 * (k2 + r2 * k3))
            x, y = (
                (xd - 2.0 * p1 * x * y - p2 * (r2 + 2.0 * x * x)) / radial,
                (yd - p1 * (r2 + 2.0 * y * y) - 2.0 * p2 * x * y) / radial,
            )
        return np.stack([x, y], axis=-1)

    def turned(self, quarter_turns: int) -> Camera:
        """Intrinsics of the same picture turned clockwise by quarter turns (1 or 3), for transposed frames."""
        fx, fy, cx, cy, k1, k2, p1, p2, k3 = self.intrinsics
        if quarter_turns % 4 == 1:  # new x = height - 1 - y, new y = x
            values = [fy, fx, self.height_px - 1 - cy, cx, k1, k2, p2, -p1, k3]
        elif quarter_turns % 4 == 3:  # new x = y, new y = width - 1 - x
            values = [fy, fx, cy, self.width_px - 1 - cx, k1, k2, -p2, p1, k3]
        else:
            raise ValueError("quarter_turns must be 1 or 3")
        return Camera(self.height_px, self.width_px, np.array(values))


@dataclass(frozen=True)
class CalibratedCamera:
    """A camera with what is known of its uncertainty, used as a weighted unknown in adjustments.

    Attributes
    ----------
    camera : Camera
    covariance : ndarray of shape (9, 9)
        Of the intrinsics, in their units squared; positive definite. For a camera of a survey it holds the
        posterior plus the scatter between photographs.
    source : str
        Where the numbers come from: survey, calibration, client, exif, model.
    readout : Readout or None
        How the sensor is read, where it is known: then a pose is that of the middle of the picture, and allows for
        movement while it was read.
    """

    camera: Camera
    covariance: Array
    source: CameraSource
    readout: Readout | None = None

    def __post_init__(self) -> None:
        if self.covariance.shape != (INTRINSIC_COUNT, INTRINSIC_COUNT) or not np.isfinite(self.covariance).all():
            raise ValueError("the covariance of the intrinsics is 9 x 9 and finite")
        if (np.diag(self.covariance) <= 0).any():
            raise ValueError("the variances of the intrinsics must be positive")
