"""The adjustment report: everything the surveyor signs, as records that turn into JSON."""

from __future__ import annotations

from dataclasses import dataclass, fields, is_dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from app.geometry.plate_sigmas import PlateSigmas
from app.photogrammetry.image_residuals import ImageResiduals

Array = npt.NDArray[np.float64]


@dataclass(frozen=True)
class PhotoRecord:
    """An oriented photograph; sigmas of position (m) and small rotation (rad), site axes."""

    name: str
    camera: str
    position_m: Array
    orientation_xyzw: Array
    position_sigma_m: Array
    rotation_sigma_rad: Array
    rms_px: float
    targets: int


@dataclass(frozen=True)
class UnorientedRecord:
    """A photograph without a pose."""

    name: str
    reason: str


@dataclass(frozen=True)
class TargetRecord:
    """A published target; ``sigma_m`` with the datum, ``own_sigma_m`` relative to it.

    ``detectable_m`` is the least displacement during the survey that is found in four of five cases, in whatever
    direction, when half of its photographs show it in either place; None where fewer than four photographs show it and
    in reports of earlier releases.
    """

    code: int
    position_m: Array
    orientation_xyzw: Array
    sigma_m: Array
    own_sigma_m: Array
    rays: int
    intersection_deg: float
    rms_px: float
    detectable_m: float | None = None


@dataclass(frozen=True)
class LeftOutRecord:
    """A target that was seen and is not published."""

    code: int
    reason: str
    detail: str


@dataclass(frozen=True)
class FalseSightingRecord:
    """A target that a photograph shows where it is not."""

    photo: str
    code: int
    sigmas: float


@dataclass(frozen=True)
class CameraRecord:
    """A camera; intrinsics fx, fy, cx, cy, k1, k2, p1, p2, k3 with sigmas, correlations and scatter of photographs."""

    key: str
    photographs: int
    width_px: int
    height_px: int
    names: tuple[str, ...]
    intrinsics: Array
    sigmas: Array
    correlations: Array
    focal_scatter: float
    centre_scatter_px: Array


@dataclass(frozen=True)
class ControlRecord:
    """A control or check point as listed; residual = map - list, site axes; None when its target is not in the map."""

    name: str
    code: int
    dot: str
    role: str
    position_m: Array
    sigma_m: float
    residual_m: Array | None


@dataclass(frozen=True)
class PrintRecord:
    """Of the batch of most targets; held as it was expected without control points."""

    scale: Array
    sigmas: Array
    held: bool


@dataclass(frozen=True)
class PrintBatchRecord:
    """Targets of one print scale: printed over nominal length along x and y, with sigmas.

    Attributes
    ----------
    name : str
        As listed; empty for targets on no list and for batches that the survey found.
    found : bool
        Whether the photographs show a batch that nobody listed.
    codes : tuple of int
    scale, sigmas : ndarray of shape (2,)
    held : bool
        Whether the map takes its scale from this batch, having no control points.
    measured : ndarray of shape (2,) or None
        What the check bars say.
    measured_sigma : float
        What was trusted in advance.
    """

    name: str
    found: bool
    codes: tuple[int, ...]
    scale: Array
    sigmas: Array
    held: bool
    measured: Array | None
    measured_sigma: float


@dataclass(frozen=True)
class DatumRecord:
    """What fixes the frame, and the sigmas of translation (m), rotation (rad) and scale that all targets share."""

    origin_m: Array
    translation_sigma_m: Array
    rotation_sigma_rad: Array
    scale_sigma: float
    assumed_scale: bool
    assumed_orientation: bool


@dataclass(frozen=True)
class AdjustmentReport:
    """The result of a survey's adjustment.

    Attributes
    ----------
    sigma0 : float
        Standard deviation of unit weight: residuals over what the dots' covariances promise.
    plate_sigmas : PlateSigmas
        The same of a plate's shift, of its linear deformation and of its single dots: 1 each where dots err alone.
    redundancy : int
        Observations minus unknowns.
    observations : int
        Image coordinates.
    steps : int
        Steps of the final adjustment.
    converged : bool
    control_rmse_m, check_rmse_m : float or None
        Root mean square 3-D residuals; None without such points.
    warnings : tuple of str
        What the surveyor should know before signing.
    image_residuals : tuple of ImageResiduals
        Of the photographs of each of ``cameras``.
    print_batches : tuple of PrintBatchRecord
        Listed ones, then those that were found; none in reports of earlier releases.
    """

    sigma0: float
    plate_sigmas: PlateSigmas
    redundancy: int
    observations: int
    steps: int
    converged: bool
    datum: DatumRecord
    print_scale: PrintRecord
    cameras: tuple[CameraRecord, ...]
    control: tuple[ControlRecord, ...]
    control_rmse_m: float | None
    check_rmse_m: float | None
    photos: tuple[PhotoRecord, ...]
    unoriented: tuple[UnorientedRecord, ...]
    targets: tuple[TargetRecord, ...]
    left_out: tuple[LeftOutRecord, ...]
    false_sightings: tuple[FalseSightingRecord, ...]
    warnings: tuple[str, ...]
    image_residuals: tuple[ImageResiduals, ...]
    print_batches: tuple[PrintBatchRecord, ...] = ()

    def to_json(self) -> dict[str, Any]:
        """A JSON-ready record of all fields, arrays as lists."""
        record = _plain(self)
        assert isinstance(record, dict)
        return record


def _plain(value: object) -> object:
    """Arrays and dataclasses as lists, dicts and numbers."""
    if isinstance(value, np.ndarray | np.generic):
        return value.tolist()
    if isinstance(value, tuple):
        return [_plain(item) for item in value]
    if is_dataclass(value) and not isinstance(value, type):
        return {field.name: _plain(getattr(value, field.name)) for field in fields(value)}
    return value
