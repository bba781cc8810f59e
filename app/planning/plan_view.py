"""From where a plan's accuracy is wanted, what is asked of a target in view, and how well the map will be known."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from app.planning.plan_fields import Field

VIEW_FIELDS = (
    "height_m",
    "step_m",
    "headings",
    "pitch_deg",
    "upright",
    "area_m",
    "clearance_m",
    "min_px_per_u",
    "max_incidence_deg",
    "min_targets",
    "map",
)
MAP_FIELDS = ("target_sigma_mm", "target_sigma_mrad", "control_points", "control_sigma_mm")
MOST_HEADINGS = 360
MM_PER_M, MRAD_PER_RAD = 1000.0, 1000.0


@dataclass(frozen=True)
class SightLimits:
    """What a target needs to count.

    Attributes
    ----------
    min_px_per_u : float
        Least size, fx u / depth: the detector reads from 2.2 px per u.
    max_incidence_deg : float
        Greatest angle between the line of sight and the plate's normal.
    min_targets : int
        Fewer in view give no position: a single plate seen from its front has two.
    """

    min_px_per_u: float = 2.2
    max_incidence_deg: float = 60.0
    min_targets: int = 2

    def __post_init__(self) -> None:
        if not (self.min_px_per_u > 0 and 0 < self.max_incidence_deg < 90 and self.min_targets >= 1):
            raise ValueError("limits are a positive size, an incidence under 90 degrees and at least one target")


@dataclass(frozen=True)
class MapExpectation:
    """What a survey will leave: standard deviations.

    Attributes
    ----------
    target_sigma_m, target_sigma_rad : float
        Of each target's position and attitude, relative to the others.
    control_points : int
        Control points that give the datum; they are taken to lie far apart.
    control_sigma_m : float
        Of each coordinate of a control point; 0 for a datum that is right by definition.
    """

    target_sigma_m: float = 2e-4
    target_sigma_rad: float = 6e-4
    control_points: int = 4
    control_sigma_m: float = 1e-3


@dataclass(frozen=True)
class ViewWish:
    """Camera positions and what is asked of them.

    Attributes
    ----------
    height_m : float
        Of the camera over the site's origin.
    step_m : float
        Of the grid.
    headings : int
        Directions at each position, equally spaced from the site's X.
    pitch_deg : float
        Upwards from the horizon.
    upright : bool
        The camera is held a quarter turn clockwise.
    area_m : tuple of float or None
        Least x and y, greatest x and y; None: what walls or targets enclose.
    clearance_m : float
        Least distance of a position from a wall.
    limits : SightLimits
    survey : MapExpectation
        For targets that no survey has measured yet.
    """

    height_m: float = 1.5
    step_m: float = 0.5
    headings: int = 16
    pitch_deg: float = 0.0
    upright: bool = False
    area_m: tuple[float, float, float, float] | None = None
    clearance_m: float = 0.25
    limits: SightLimits = SightLimits()
    survey: MapExpectation = MapExpectation()

    def __post_init__(self) -> None:
        if not (self.step_m > 0 and self.headings >= 1 and abs(self.pitch_deg) < 90 and self.clearance_m >= 0):
            raise ValueError("a grid has a positive step, a heading or more, and looks neither straight up nor down")


def read_view(field: Field) -> ViewWish:
    """The object ``view``.

    Raises
    ------
    InvalidInput
        Naming line and field.
    """
    members = field.members(*VIEW_FIELDS)
    wish = ViewWish()
    return ViewWish(
        height_m=members["height_m"].number() if "height_m" in members else wish.height_m,
        step_m=members["step_m"].positive() if "step_m" in members else wish.step_m,
        headings=members["headings"].integer(1, MOST_HEADINGS) if "headings" in members else wish.headings,
        pitch_deg=members["pitch_deg"].number(-80.0, 80.0) if "pitch_deg" in members else wish.pitch_deg,
        upright=members["upright"].flag() if "upright" in members else wish.upright,
        area_m=_area(members["area_m"]) if "area_m" in members else None,
        clearance_m=members["clearance_m"].number(0.0) if "clearance_m" in members else wish.clearance_m,
        limits=_limits(members),
        survey=_survey(members["map"]) if "map" in members else wish.survey,
    )


def _area(field: Field) -> tuple[float, float, float, float]:
    west, south, east, north = field.vector(4).tolist()
    if not (west <= east and south <= north):
        raise field.error("least x and y come first, then greatest x and y")
    return west, south, east, north


def _limits(members: dict[str, Field]) -> SightLimits:
    limits = SightLimits()
    return SightLimits(
        members["min_px_per_u"].positive() if "min_px_per_u" in members else limits.min_px_per_u,
        members["max_incidence_deg"].number(1.0, 89.0) if "max_incidence_deg" in members else limits.max_incidence_deg,
        members["min_targets"].integer(1, np.iinfo(np.int16).max) if "min_targets" in members else limits.min_targets,
    )


def _survey(field: Field) -> MapExpectation:
    members = field.members(*MAP_FIELDS)
    survey = MapExpectation()
    mm, mrad = members.get("target_sigma_mm"), members.get("target_sigma_mrad")
    points, control_mm = members.get("control_points"), members.get("control_sigma_mm")
    return MapExpectation(
        survey.target_sigma_m if mm is None else mm.positive() / MM_PER_M,
        survey.target_sigma_rad if mrad is None else mrad.positive() / MRAD_PER_RAD,
        survey.control_points if points is None else points.integer(3, 1000),
        survey.control_sigma_m if control_mm is None else control_mm.number(0.0) / MM_PER_M,
    )
