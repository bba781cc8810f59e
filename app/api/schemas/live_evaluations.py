"""Live evaluations: a running system beside a reference that is being located."""

from __future__ import annotations

import math
from typing import Annotated, Any, Literal

from pydantic import AfterValidator, BaseModel, BeforeValidator, Field

from app.api.dependencies import Id
from app.api.schemas.common import WHOLE, Body, Finite, Listing, Vector3, time_of
from app.api.schemas.evaluations import GREATEST_GAP_S, GREATEST_S, Metres
from app.api.schemas.texts import Text
from app.services.capture_time import LATEST_S
from app.services.live_events import LiveNews
from app.services.live_tally import Tally, distances_m, latency_of
from app.storage.live_records import LiveEvaluation, LiveOptions, LivePair, Sample
from app.storage.paging import Page
from app.trajectories.alignment import LEAST_PAIRS, Alignment

MOST_SAMPLES = 1000  # of one request
GREATEST_M = 1e6
GREATEST_FLOOR = 1000
LENGTH_TOLERANCE = 0.01  # of a quaternion, as in files
AFTERWARDS = ("estimate", "origin")  # a clock's offset, an alignment by orientations

Coordinate = Annotated[Finite, Field(ge=-GREATEST_M, le=GREATEST_M)]


def _unit(quaternion: list[float]) -> list[float]:
    length = math.sqrt(sum(value * value for value in quaternion))
    if abs(length - 1.0) > LENGTH_TOLERANCE:
        raise ValueError(f"has the length {length:.4g}, and 1 is needed")
    return [value / length for value in quaternion]


def _known_while_walking(told: object) -> object:
    """What takes a whole walk is refused with the way to it."""
    if told in AFTERWARDS:
        raise ValueError(
            f"{told!r} takes the whole walk: open without it, and when the walk is over keep the samples (POST "
            "/evaluations/live/{live_id}/trajectory) and evaluate them with every option (POST /evaluations)"
        )
    return told


class LiveOptionsBody(Body):
    """How samples are compared; the reference is interpolated at each."""

    max_gap_s: Annotated[Finite, Field(ge=0, le=GREATEST_GAP_S)] = 1.0
    time_offset_s: Annotated[Finite, BeforeValidator(_known_while_walking), Field(ge=-GREATEST_S, le=GREATEST_S)] = 0.0
    lever_arm_m: Annotated[list[Metres], Field(min_length=3, max_length=3)] | None = None
    floor_height_m: Annotated[Finite, Field(gt=0.1, le=100)] | None = None
    alignment: Annotated[
        Literal["none", "posyaw", "se3", "sim3", "first_n"],
        BeforeValidator(_known_while_walking),
        Field(description="Of all pairs so far, by their positions, fitted anew as pairs come."),
    ] = "none"
    first_n: Annotated[int, Field(ge=LEAST_PAIRS, le=2**31 - 1, strict=True), WHOLE] = 10

    def to_domain(self) -> LiveOptions:
        """The options."""
        arm = self.lever_arm_m
        arm_m = None if arm is None else (arm[0], arm[1], arm[2])
        return LiveOptions(self.max_gap_s, self.time_offset_s, arm_m, self.floor_height_m, self.alignment, self.first_n)


class NewLiveBody(Body):
    """A live evaluation to be opened."""

    reference_id: Id
    name: Annotated[Text | None, Field(description="The system, for people.")] = None
    options: LiveOptionsBody = LiveOptionsBody()


class SampleBody(Body):
    """A position that the running system tells."""

    time_s: Annotated[Finite, Field(ge=0, le=LATEST_S, description="UTC seconds since 1970; a moment counts once.")]
    x_m: Coordinate
    y_m: Coordinate
    z_m: Annotated[Coordinate | None, Field(description="Left out by a system that tells the plan alone.")] = None
    floor: Annotated[int, WHOLE, Field(ge=-GREATEST_FLOOR, le=GREATEST_FLOOR, strict=True)] | None = None
    orientation: Annotated[
        Annotated[list[Finite], Field(min_length=4, max_length=4), AfterValidator(_unit)] | None,
        Field(description="x, y, z, w of site_from_device."),
    ] = None

    def to_domain(self) -> Sample:
        """The sample."""
        turn = self.orientation
        orientation = None if turn is None else (turn[0], turn[1], turn[2], turn[3])
        return Sample(self.time_s, self.x_m, self.y_m, self.z_m, self.floor, orientation)


class SamplesBody(Body):
    """Positions of the running system, in any order."""

    samples: Annotated[list[SampleBody], Field(min_length=1, max_length=MOST_SAMPLES)]


class LiveAnswer(BaseModel):
    """A live evaluation as it stands."""

    live_id: str
    site_id: str
    reference_id: str
    name: str
    options: dict[str, Any]
    created_at: str
    closed_at: str | None
    count: int = Field(description="Samples that came.")
    matched: int
    waiting: int = Field(description="Samples that wait for a later pose of the reference.")
    missed: int = Field(description="Samples that the reference passed by without a pose near enough.")

    @classmethod
    def of(cls, live: LiveEvaluation, **more: Any) -> Any:
        """The answer for a live evaluation."""
        arm_m = live.options.lever_arm_m
        options = {
            "max_gap_s": live.options.max_gap_s,
            "time_offset_s": live.options.time_offset_s,
            "lever_arm_m": None if arm_m is None else list(arm_m),
            "floor_height_m": live.options.floor_height_m,
            "alignment": live.options.alignment,
            "first_n": live.options.first_n,
        }
        return cls(
            live_id=live.live_id,
            site_id=live.site_id,
            reference_id=live.reference_id,
            name=live.name,
            options=options,
            created_at=time_of(live.created_s),
            closed_at=None if live.closed_s is None else time_of(live.closed_s),
            count=live.sample_count,
            matched=live.pair_count,
            waiting=live.waiting_count,
            missed=live.missed_count,
            **more,
        )


class LivesAnswer(Listing):
    """A page of live evaluations."""

    live_evaluations: list[LiveAnswer] = Field(description="As they were left at the last look at each.")

    @classmethod
    def of(cls, page: Page[LiveEvaluation]) -> LivesAnswer:
        """The answer for a page."""
        return cls(live_evaluations=[LiveAnswer.of(item) for item in page.items], next_cursor=page.next_cursor)


class KeptSamplesBody(Body):
    """The samples as a trajectory."""

    name: Annotated[Text | None, Field(description="For people; the live evaluation's name unless told.")] = None


class SamplesAnswer(BaseModel):
    """What became of samples."""

    accepted: int
    duplicates: int = Field(description="Samples whose moment had one already; the first one counts.")
    matched: int
    waiting: int
    missed: int

    @classmethod
    def of(cls, live: LiveEvaluation, sent: int, added: int) -> SamplesAnswer:
        """The answer to a request with samples."""
        return cls(
            accepted=added,
            duplicates=sent - added,
            matched=live.pair_count,
            waiting=live.waiting_count,
            missed=live.missed_count,
        )


class AlignmentAnswer(BaseModel):
    """position in the site = scale * rotation * position of the system + translation."""

    kind: str
    pairs_used: int
    scale: float
    rotation: list[Vector3]
    translation_m: Vector3

    @classmethod
    def of(cls, alignment: Alignment) -> AlignmentAnswer:
        """The answer for an alignment."""
        found = alignment.site_from_estimate
        return cls(
            kind=alignment.kind,
            pairs_used=alignment.pairs_used,
            scale=found.scale,
            rotation=found.rotation.tolist(),
            translation_m=found.translation_m.tolist(),
        )


class ErrorAnswer(BaseModel):
    """What pairs amount to, metres; null without a pair, and while the pairs do not fix the alignment."""

    rmse_m: float | None
    mean_m: float | None
    CE50_m: float | None
    CE95_m: float | None
    latency_s: float | None = Field(description="Median of how long after their moment samples reached the server.")
    alignment: AlignmentAnswer | None = Field(description="Null when none was asked for, and until it is fixed.")

    @classmethod
    def of(cls, tally: Tally) -> ErrorAnswer:
        """The answer for the error so far."""
        so_far = tally.so_far
        return cls(
            rmse_m=None if so_far is None else so_far.rmse_m,
            mean_m=None if so_far is None else so_far.mean_m,
            CE50_m=None if so_far is None else so_far.ce50_m,
            CE95_m=None if so_far is None else so_far.ce95_m,
            latency_s=tally.latency_s,
            alignment=None if tally.alignment is None else AlignmentAnswer.of(tally.alignment),
        )


class LiveStateAnswer(LiveAnswer):
    """A live evaluation with the error so far."""

    error: ErrorAnswer


class PairAnswer(BaseModel):
    """The sample that was paired last."""

    time_s: float
    error_m: list[float | None] = Field(description="Estimate less reference, x, y, z; z null for a plan alone.")
    horizontal_m: float
    distance_m: float
    angle_rad: float | None = Field(description="Null without orientations, and for a system that is aligned.")
    reference_sigma_m: float | None
    right_floor: bool | None
    latency_s: float | None

    @classmethod
    def of(cls, pair: LivePair, options: LiveOptions) -> PairAnswer:
        """The answer for a pair."""
        horizontal_m, distance_m = distances_m(pair)
        return cls(
            time_s=pair.time_s,
            error_m=list(pair.error_m),
            horizontal_m=horizontal_m,
            distance_m=distance_m,
            angle_rad=pair.angle_rad,
            reference_sigma_m=pair.reference_sigma_m,
            right_floor=pair.right_floor,
            latency_s=latency_of(pair, options),
        )


class ErrorEvent(ErrorAnswer):
    """The error so far after one more pair."""

    matched: int = Field(description="Pairs up to this one.")
    count: int
    waiting: int
    missed: int
    last: PairAnswer | None

    @classmethod
    def of_news(cls, news: LiveNews) -> ErrorEvent:
        """The event for a new pair."""
        return cls(
            **ErrorAnswer.of(news.tally).model_dump(),
            matched=news.number,
            count=news.live.sample_count,
            waiting=news.live.waiting_count,
            missed=news.live.missed_count,
            last=None if news.pair is None else PairAnswer.of(news.pair, news.live.options),
        )
