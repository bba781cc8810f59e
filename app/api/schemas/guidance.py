"""What a survey lacks while it is photographed."""

from __future__ import annotations

from typing import Annotated

import numpy as np
from pydantic import BaseModel, Field

from app.api.schemas.common import Vector3, numbers_of
from app.photogrammetry.survey_guidance import Frame, Guidance, GuidedTarget, TargetState
from app.photogrammetry.viewpoints import Shot
from app.services.guidance_words import advice_for, place_in_words, summary_of
from app.services.survey_guide import SurveyGuidance


class ShotAnswer(BaseModel):
    """Where to stand and what to look at."""

    position_m: Annotated[Vector3, Field(description="In the frame that the guidance names.")]
    facing_m: Vector3
    beside: str = Field(description="The photograph that was taken nearest to there.")
    right_m: float = Field(description="From there to the right, for whoever faces the target; left is negative.")
    back_m: float = Field(description="Away from the target; nearer is negative.")
    up_m: float
    text: str

    @classmethod
    def of(cls, shot: Shot, frame: Frame) -> ShotAnswer:
        """The answer for a viewpoint."""
        return cls(
            position_m=numbers_of(shot.eye_m),
            facing_m=numbers_of(shot.aim_m),
            beside=shot.beside,
            right_m=shot.right_m,
            back_m=shot.back_m,
            up_m=shot.up_m,
            text=place_in_words(shot, frame),
        )


class GuidedTargetAnswer(BaseModel):
    """What one target has and lacks."""

    code: int
    state: TargetState
    rays: int = Field(description="Photographs that show it.")
    angle_deg: float | None = Field(description="Greatest angle between two of its rays; null without a place yet.")
    control: bool = Field(description="Whether it carries a control or check point.")
    companions: list[int] = Field(description="Targets to photograph together with it.")
    shot: ShotAnswer | None
    advice: str = Field(description="Empty when nothing is lacking.")

    @classmethod
    def of(cls, target: GuidedTarget, guidance: Guidance) -> GuidedTargetAnswer:
        """The answer for a target."""
        return cls(
            code=target.code,
            state=target.state,
            rays=target.rays,
            angle_deg=None if target.angle_rad is None else float(np.degrees(target.angle_rad)),
            control=target.control,
            companions=list(target.companions),
            shot=None if target.shot is None else ShotAnswer.of(target.shot, guidance.frame),
            advice=advice_for(target, guidance),
        )


class NextShotAnswer(BaseModel):
    """The photograph that helps most targets at once."""

    shot: ShotAnswer
    codes: list[int]


class GuidanceAnswer(BaseModel):
    """What a survey has and lacks."""

    photographs: int = Field(description="Those that were looked at.")
    pending: int = Field(description="Photographs that are still to be looked at; ask again.")
    unusable: list[str] = Field(description="Names of photographs that no detector can read.")
    oriented: int
    loose: list[str] = Field(description="Photographs with targets that do not hang together with the others.")
    frame: Frame = Field(description="site: coordinates of the site; model: of a frame of their own; none: no places.")
    fewest_rays: int
    least_angle_deg: float
    summary: str
    next_shot: NextShotAnswer | None
    targets: list[GuidedTargetAnswer]

    @classmethod
    def of(cls, found: SurveyGuidance) -> GuidanceAnswer:
        """The answer for a survey's guidance."""
        guidance, wanted = found.guidance, found.guidance.next_shot
        return cls(
            photographs=guidance.photographs,
            pending=found.pending,
            unusable=list(found.unusable),
            oriented=guidance.oriented,
            loose=list(guidance.loose),
            frame=guidance.frame,
            fewest_rays=guidance.fewest_rays,
            least_angle_deg=float(np.degrees(guidance.least_angle_rad)),
            summary=summary_of(guidance),
            next_shot=None
            if wanted is None
            else NextShotAnswer(shot=ShotAnswer.of(wanted.shot, guidance.frame), codes=list(wanted.codes)),
            targets=[GuidedTargetAnswer.of(target, guidance) for target in guidance.targets],
        )
