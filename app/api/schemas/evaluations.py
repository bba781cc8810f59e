"""Evaluations: systems under test beside a reference."""

from __future__ import annotations

from typing import Annotated, Any, Literal

import numpy as np
from pydantic import BaseModel, Field

from app.api.dependencies import Id
from app.api.schemas.common import WHOLE, Body, Finite, Listing, Vector3, time_of
from app.api.schemas.texts import Text
from app.services.evaluate_work import EvaluationWish
from app.services.evaluation_report_work import ToldEvaluation
from app.storage.evaluation_records import EvaluatedSystem, StoredEvaluation
from app.storage.paging import Page
from app.trajectories.alignment import AlignmentOptions
from app.trajectories.association import AssociationOptions
from app.trajectories.evaluation import EvaluationOptions
from app.trajectories.metrics.bootstrap import BootstrapOptions
from app.trajectories.metrics.zones import Zone

ESTIMATED = "estimate"
GREATEST_S = 1e10  # of an offset: one clock may count from 1970 and the other from its own start
GREATEST_GAP_S = 1e6
GREATEST_ARM_M = 100.0
MOST_SYSTEMS = 20
MOST_ZONES = 200
FILES = ("html", "pdf", "zip")

Metres = Annotated[Finite, Field(ge=-GREATEST_ARM_M, le=GREATEST_ARM_M)]
Corner = Annotated[list[Finite], Field(min_length=2, max_length=2)]


class ZoneBody(Body):
    """A named part of the plan."""

    name: Text
    corners_m: Annotated[list[Corner], Field(min_length=3, max_length=1000, description="x and y; closes itself.")]


class BootstrapBody(Body):
    """Confidence intervals."""

    resamples: Annotated[int, Field(ge=100, le=10_000, strict=True), WHOLE] = 2000
    confidence: Annotated[Finite, Field(ge=0.5, le=0.999)] = 0.95
    block: Annotated[
        Annotated[int, Field(ge=1, le=2**31 - 1, strict=True), WHOLE] | None,
        Field(description="Errors that stay together; null: found from their autocorrelation."),
    ] = None
    seed: Annotated[int, Field(ge=0, le=2**31 - 1, strict=True), WHOLE] = 1


class OptionsBody(Body):
    """How systems are compared with the reference."""

    association: Literal["interpolate", "nearest", "last"] = "interpolate"
    max_gap_s: Annotated[Finite, Field(ge=0, le=GREATEST_GAP_S)] = 1.0
    course: Literal["linear", "spline"] = "linear"
    time_offset_s: Annotated[
        Annotated[Finite, Field(ge=-GREATEST_S, le=GREATEST_S)] | Literal["estimate"],
        Field(description="The reference's clock less the estimate's."),
    ] = 0.0
    alignment: Literal["none", "se3", "posyaw", "sim3", "origin", "first_n"] = "none"
    first_n: Annotated[int, Field(ge=3, le=2**31 - 1, strict=True), WHOLE] = 10
    rotation_from: Literal["positions", "orientations"] = "positions"
    lever_arm_m: Annotated[
        Annotated[list[Metres], Field(min_length=3, max_length=3)] | None,
        Field(description="From the camera to the point that the system locates: right, down, forward."),
    ] = None
    floor_height_m: Annotated[Finite, Field(gt=0.1, le=100)] | None = None
    zones: list[ZoneBody] = Field(default_factory=list, max_length=MOST_ZONES)
    bootstrap: BootstrapBody = BootstrapBody()

    def to_domain(self) -> EvaluationOptions:
        """The options."""
        arm_m = self.lever_arm_m
        return EvaluationOptions(
            association=AssociationOptions(self.association, self.max_gap_s, self.course),
            alignment=AlignmentOptions(self.alignment, self.first_n, self.rotation_from),
            time_offset_s=None if self.time_offset_s == ESTIMATED else float(self.time_offset_s),
            lever_arm_m=None if arm_m is None else np.array(arm_m, dtype=np.float64),
            floor_height_m=self.floor_height_m,
            zones=tuple(Zone(zone.name, np.array(zone.corners_m, dtype=np.float64)) for zone in self.zones),
            bootstrap=BootstrapOptions(**self.bootstrap.model_dump()),
        )


class EvaluationBody(Body):
    """What is to be evaluated: one system as estimate_id, or several as estimate_ids."""

    reference_id: Id
    estimate_id: Id | None = None
    estimate_ids: list[Id] = Field(default_factory=list, max_length=MOST_SYSTEMS)
    title: Annotated[Text | None, Field(description="Of the report.")] = None
    options: OptionsBody = OptionsBody()

    def to_domain(self) -> EvaluationWish:
        """The wish.

        Raises
        ------
        InvalidInput
            When it names no system, one twice, or the reference as a system.
        """
        one = () if self.estimate_id is None else (self.estimate_id,)
        estimates = (*one, *self.estimate_ids)
        return EvaluationWish(self.reference_id, estimates, self.options.to_domain(), self.title or "")


class SeriesAnswer(BaseModel):
    """Errors pair by pair, for plots."""

    every: int = Field(description="1: all pairs are here; n: every n-th, the zip holds all.")
    time_s: list[float]
    reference_m: list[Vector3]
    error_m: list[Vector3] = Field(description="Estimate less reference.")
    angle_rad: list[float] | None


class SystemAnswer(BaseModel):
    """One system beside the reference."""

    trajectory_id: str | None = Field(description="Null when the trajectory was removed since.")
    name: str
    metrics: dict[str, Any]
    series: SeriesAnswer


class EvaluationAnswer(BaseModel):
    """An evaluation; metrics and series are those of its system, null when there are several."""

    evaluation_id: str
    site_id: str
    title: str
    reference_id: str | None
    reference_name: str
    created_at: str
    options: dict[str, Any]
    systems: list[SystemAnswer]
    differences: list[dict[str, Any]] = Field(description="Paired, of every two systems.")
    metrics: dict[str, Any] | None
    series: SeriesAnswer | None
    plots: dict[str, str] = Field(description="Where the report is, by format.")

    @classmethod
    def of(cls, told: ToldEvaluation) -> EvaluationAnswer:
        """The answer for an evaluation."""
        stored = told.stored
        systems = [
            SystemAnswer(
                trajectory_id=system.trajectory_id,
                name=system.name,
                metrics=system.record,
                series=SeriesAnswer(**series),
            )
            for system, series in zip(stored.systems, told.series, strict=True)
        ]
        only = systems[0] if len(systems) == 1 else None
        return cls(
            **_heading_of(stored),
            options=stored.options,
            systems=systems,
            differences=stored.differences,
            metrics=None if only is None else only.metrics,
            series=None if only is None else only.series,
            plots={kind: f"/evaluations/{stored.evaluation_id}?format={kind}" for kind in FILES},
        )


class ListedSystem(BaseModel):
    """A system of a listed evaluation."""

    trajectory_id: str | None
    name: str
    pairs: int
    rms_m: float = Field(description="Of the distance in space.")
    CE95_m: float

    @classmethod
    def of(cls, system: EvaluatedSystem) -> ListedSystem:
        """The entry for a system."""
        accuracy = system.record["accuracy"]
        return cls(
            trajectory_id=system.trajectory_id,
            name=system.name,
            pairs=system.record["pairs"],
            rms_m=accuracy["spatial_m"]["rms"],
            CE95_m=accuracy["CE95_m"],
        )


class ListedEvaluation(BaseModel):
    """An evaluation in short."""

    evaluation_id: str
    site_id: str
    title: str
    reference_id: str | None
    reference_name: str
    created_at: str
    systems: list[ListedSystem]


class EvaluationsAnswer(Listing):
    """A page of evaluations."""

    evaluations: list[ListedEvaluation]

    @classmethod
    def of(cls, page: Page[StoredEvaluation]) -> EvaluationsAnswer:
        """The answer for a page."""
        listed = [
            ListedEvaluation(**_heading_of(item), systems=[ListedSystem.of(system) for system in item.systems])
            for item in page.items
        ]
        return cls(evaluations=listed, next_cursor=page.next_cursor)


def _heading_of(stored: StoredEvaluation) -> dict[str, Any]:
    return {
        "evaluation_id": stored.evaluation_id,
        "site_id": stored.site_id,
        "title": stored.title,
        "reference_id": stored.reference_id,
        "reference_name": stored.reference_name,
        "created_at": time_of(stored.created_s),
    }
