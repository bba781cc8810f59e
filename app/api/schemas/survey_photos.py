"""What was seen in one photograph of a survey."""

from __future__ import annotations

from typing import Annotated

import numpy as np
import numpy.typing as npt
from pydantic import BaseModel, Field

from app.geometry.observations import Rejected, TargetObservation
from app.services.photo_viewer import SeenPhoto
from app.targets.layout import DOT_COUNT
from app.vision.judgement import REASON_TEXT

Point = Annotated[list[float], Field(min_length=2, max_length=2)]
DIGITS_PX = 3


class SeenTargetAnswer(BaseModel):
    """A target that was found."""

    code: int
    dots_px: Annotated[list[Point], Field(min_length=DOT_COUNT, max_length=DOT_COUNT, description="Row-major cells.")]
    measured: Annotated[list[bool], Field(description="False: the plate's prediction, not used.")]
    sigma_px: Annotated[list[float], Field(description="Of each dot, along the worst direction.")]
    corrected: int = Field(description="Digits that the code family changed.")
    erased: int = Field(description="Hidden digits that the code family filled.")
    rms_px: float

    @classmethod
    def of(cls, target: TargetObservation) -> SeenTargetAnswer:
        """The answer for an observation."""
        sigma_px = np.sqrt(np.linalg.eigvalsh(target.covariances_px2)[:, -1])
        return cls(
            code=target.code,
            dots_px=_points(target.centres_px),
            measured=target.measured.tolist(),
            sigma_px=np.round(sigma_px, DIGITS_PX).tolist(),
            corrected=target.corrected,
            erased=target.erased,
            rms_px=target.rms_px,
        )


class RefusedAnswer(BaseModel):
    """Something that was looked at and refused."""

    reason: str = Field(description="A stable slug.")
    text: str = Field(description="The same for a person.")
    code: int | None
    centre_px: Point
    corners_px: list[Point] | None

    @classmethod
    def of(cls, rejected: Rejected) -> RefusedAnswer:
        """The answer for a refusal."""
        corners_px = rejected.corners_px
        return cls(
            reason=rejected.reason,
            text=rejected.detail or REASON_TEXT.get(rejected.reason, rejected.reason),
            code=rejected.code,
            centre_px=_points(rejected.centre_px[None])[0],
            corners_px=None if corners_px is None else _points(corners_px[np.isfinite(corners_px).all(axis=1)]),
        )


class DetectionAnswer(BaseModel):
    """What a detector saw in a photograph; pixel (0, 0) is the centre of the sensor's first."""

    name: str
    width_px: int
    height_px: int
    quarter_turns: int = Field(description="Clockwise, that show it upright; nothing here is turned.")
    targets: list[SeenTargetAnswer]
    rejected: list[RefusedAnswer]

    @classmethod
    def of(cls, seen: SeenPhoto) -> DetectionAnswer:
        """The answer for a photograph."""
        return cls(
            name=seen.photo.name,
            width_px=seen.detection.width_px,
            height_px=seen.detection.height_px,
            quarter_turns=seen.quarter_turns,
            targets=[SeenTargetAnswer.of(target) for target in seen.detection.targets],
            rejected=[RefusedAnswer.of(rejected) for rejected in seen.detection.rejected],
        )


def _points(points_px: npt.NDArray[np.float64]) -> list[list[float]]:
    rounded: list[list[float]] = np.round(points_px, DIGITS_PX).tolist()
    return rounded
