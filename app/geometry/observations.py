"""What a detector sees in one photograph: targets with their dot centres, and what it refused."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from math import isfinite
from typing import Any

import numpy as np
import numpy.typing as npt

from app.geometry.plate_sigmas import INDEPENDENT_DOTS, PlateSigmas
from app.targets.layout import DOT_COUNT

Array = npt.NDArray[np.float64]


@dataclass(frozen=True)
class TargetObservation:
    """One target seen in one photograph.

    Attributes
    ----------
    code : int
        The decoded code.
    centres_px : ndarray of shape (16, 2)
        Images of the dots' centres (not of the ellipses' centres: eccentricity is removed), row-major cells.
        Where ``measured`` is False it is the plate's prediction and carries no information.
    covariances_px2 : ndarray of shape (16, 2, 2)
        Of each centre; positive definite.
    measured : ndarray of shape (16,), bool
        Which dots were measured in the pixels.
    corrected : int
        Digits that the code family changed.
    erased : int
        Digits that were hidden and filled by the code family.
    rms_px : float
        Root mean square of the measured dots about the plate's homography, per coordinate.
    plate_sigmas : PlateSigmas
        How much of their errors the dots share, over what the covariances say: all three 1 when they err alone.
    """

    code: int
    centres_px: Array
    covariances_px2: Array
    measured: npt.NDArray[np.bool_]
    corrected: int = 0
    erased: int = 0
    rms_px: float = 0.0
    plate_sigmas: PlateSigmas = INDEPENDENT_DOTS

    def __post_init__(self) -> None:
        if self.centres_px.shape != (DOT_COUNT, 2) or self.covariances_px2.shape != (DOT_COUNT, 2, 2):
            raise ValueError("a target observation holds sixteen centres with a covariance each")
        if self.measured.shape != (DOT_COUNT,) or self.measured.dtype != np.bool_:
            raise ValueError("measured is sixteen booleans")
        if not isfinite(np.vdot(self.centres_px, self.centres_px)):  # one call: this is made for each target seen
            raise ValueError("centres must be finite")

    @property
    def centre_px(self) -> Array:
        """The middle of the plate's dots, shape (2,)."""
        return self.centres_px.mean(axis=0)


@dataclass(frozen=True)
class Rejected:
    """Something that was looked at and refused.

    Attributes
    ----------
    reason : str
        A stable slug.
    centre_px : ndarray of shape (2,)
        Where it is.
    detail : str
        What was wrong, for a person.
    code : int or None
        The code, when one was read.
    corners_px : ndarray of shape (N, 2) or None
        The dots or corners that were considered, for drawing.
    """

    reason: str
    centre_px: Array
    detail: str = ""
    code: int | None = None
    corners_px: Array | None = None


@dataclass(frozen=True)
class Detection:
    """All that was seen in one photograph, codes unique."""

    width_px: int
    height_px: int
    targets: tuple[TargetObservation, ...]
    rejected: tuple[Rejected, ...] = ()

    def __post_init__(self) -> None:
        codes = [target.code for target in self.targets]
        if len(set(codes)) != len(codes):
            raise ValueError("one code stands once in a detection")


def observation_to_json(observation: TargetObservation) -> dict[str, Any]:
    """A JSON-ready record of an observation; ``observation_from_json`` reads it back exactly."""
    return {
        "code": observation.code,
        "dots_px": observation.centres_px.tolist(),
        "covariances_px2": observation.covariances_px2.tolist(),
        "measured": observation.measured.tolist(),
        "corrected": observation.corrected,
        "erased": observation.erased,
        "rms_px": observation.rms_px,
        "plate_sigmas": asdict(observation.plate_sigmas),
    }


def observation_from_json(record: dict[str, Any]) -> TargetObservation:
    """The observation of a record written by ``observation_to_json``."""
    return TargetObservation(
        code=int(record["code"]),
        centres_px=np.array(record["dots_px"], dtype=np.float64),
        covariances_px2=np.array(record["covariances_px2"], dtype=np.float64),
        measured=np.array(record["measured"], dtype=np.bool_),
        corrected=int(record["corrected"]),
        erased=int(record["erased"]),
        rms_px=float(record["rms_px"]),
        plate_sigmas=PlateSigmas(**record["plate_sigmas"]),
    )
