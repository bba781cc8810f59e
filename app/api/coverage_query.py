"""Which prediction is wanted, as the query says it."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Annotated

import numpy as np
import numpy.typing as npt
from fastapi import Depends, Query

from app.api.dependencies import Id, PathId, Version
from app.errors import InvalidInput
from app.geometry.camera import CalibratedCamera, Camera
from app.planning.dot_errors import Light
from app.planning.plan_camera import FILM_WIDTH_MM, MOST_PX, known_from
from app.planning.plan_view import MOST_HEADINGS, SightLimits, ViewWish
from app.planning.plan_walls import Wall, upright_wall, walls_of_outline
from app.planning.suggestions import Over, SuggestionOptions
from app.planning.survey_plan import phone_camera
from app.services.coverage_report.prediction import CoverageFormat
from app.services.coverage_work import CoverageTask, PhoneWish, SiteView

Array = npt.NDArray[np.float64]

MOST_SUGGESTIONS = 10
PLACE = r"-?[0-9]{1,5}(\.[0-9]{1,4})?,-?[0-9]{1,5}(\.[0-9]{1,4})?"
OUTLINE_PATTERN = rf"^{PLACE}( {PLACE}){{2,}}$"
WALLS_PATTERN = rf"^{PLACE} {PLACE}(;{PLACE} {PLACE})*$"
AREA_PATTERN = rf"^{PLACE} {PLACE}$"

OUTLINE = (
    "The room from above: corners x,y in metres with blanks between; its walls look inwards, hide and carry targets."
)
WALLS = "Single walls: from x,y to x,y, as seen from their front from left to right; several with ; between."
AREA = "Least and greatest x,y of the positions; what the walls or the targets enclose if none."
CAMERA = "A camera of GET /cameras; that of the site's survey if none is named or described."
FOCAL = "35 mm equivalent, by width, of a camera that is described by its size; a typical phone's if none."


def site_view(
    site_id: PathId,
    version: Version | None = None,
    outline: Annotated[
        str | None,
        Query(max_length=4000, pattern=OUTLINE_PATTERN, description=OUTLINE, examples=["0,0 20,0 20,10 0,10"]),
    ] = None,
    walls: Annotated[
        str | None, Query(max_length=4000, pattern=WALLS_PATTERN, description=WALLS, examples=["14,0 14,4"])
    ] = None,
    wall_height_m: Annotated[float, Query(gt=0, le=100, description="From the site's origin up.")] = 3.0,
) -> SiteView:
    """The part of the query that says where."""
    found = [] if outline is None else _outline(outline, wall_height_m)
    for number, text in enumerate([] if walls is None else walls.split(";"), start=1):
        left, right = _places(text)
        if np.array_equal(left, right):
            raise InvalidInput("a wall leads from one place to another", field="walls")
        found.append(upright_wall(f"wall.{number}", left, right, (0.0, wall_height_m)))
    return SiteView(site_id, version, tuple(found))


def phone_wish(
    camera_id: Annotated[Id | None, Query(description=CAMERA)] = None,
    width_px: Annotated[int | None, Query(ge=16, le=MOST_PX, description="With height_px: another phone.")] = None,
    height_px: Annotated[int | None, Query(ge=16, le=MOST_PX)] = None,
    focal_35mm: Annotated[float | None, Query(ge=10, le=200, allow_inf_nan=False, description=FOCAL)] = None,
    light: Annotated[Light, Query(description="How well dots are seen.")] = "indoor",
) -> PhoneWish:
    """The part of the query that says whose photographs."""
    if width_px is None or height_px is None:
        if width_px is not None or height_px is not None or focal_35mm is not None:
            raise InvalidInput("a phone is described by width_px and height_px, and focal_35mm", field="width_px")
        return PhoneWish(camera_id, None, light)
    if camera_id is not None:
        raise InvalidInput("name a camera or describe one, not both", field="camera_id")
    return PhoneWish(None, _described(width_px, height_px, focal_35mm), light)


@dataclass(frozen=True)
class _Grid:
    area_m: tuple[float, float, float, float] | None
    step_m: float
    clearance_m: float


def grid(
    step_m: Annotated[float, Query(ge=0.05, le=100, allow_inf_nan=False, description="Between positions.")] = 0.5,
    area: Annotated[str | None, Query(max_length=100, pattern=AREA_PATTERN, description=AREA)] = None,
    clearance_m: Annotated[float, Query(ge=0, le=10, description="Of positions from walls.")] = 0.25,
) -> _Grid:
    """The part of the query that says at which positions."""
    if area is None:
        return _Grid(None, step_m, clearance_m)
    low, high = _places(area)
    if (low > high).any():
        raise InvalidInput("the area's least x and y come first", field="area")
    return _Grid((float(low[0]), float(low[1]), float(high[0]), float(high[1])), step_m, clearance_m)


def limits(
    min_px_per_u: Annotated[float, Query(gt=0, le=100, description="Least size of a target that counts.")] = 2.2,
    max_incidence_deg: Annotated[float, Query(ge=1, le=89, description="Greatest slant of one that counts.")] = 60.0,
    min_targets: Annotated[int, Query(ge=1, le=100, description="In view, for a camera to be located.")] = 2,
) -> SightLimits:
    """The part of the query that says what is asked of a target."""
    return SightLimits(min_px_per_u, max_incidence_deg, min_targets)


def directions(
    height_m: Annotated[float, Query(ge=-1000, le=1000, description="Of the camera over the site's origin.")] = 1.5,
    headings: Annotated[int, Query(ge=1, le=MOST_HEADINGS, description="Directions at each position.")] = 16,
    pitch_deg: Annotated[float, Query(ge=-80, le=80, description="Upwards.")] = 0.0,
    upright: Annotated[bool, Query(description="Whether the camera is held upright.")] = False,
) -> ViewWish:
    """The part of the query that says how high and which way."""
    return ViewWish(height_m=height_m, headings=headings, pitch_deg=pitch_deg, upright=upright)


def view_wish(
    directed: Annotated[ViewWish, Depends(directions)],
    wanted: Annotated[_Grid, Depends(grid)],
    asked: Annotated[SightLimits, Depends(limits)],
) -> ViewWish:
    """Positions, directions and what is asked of a target."""
    return replace(directed, area_m=wanted.area_m, step_m=wanted.step_m, clearance_m=wanted.clearance_m, limits=asked)


def suggestion_wish(
    suggest: Annotated[int, Query(ge=0, le=MOST_SUGGESTIONS, description="Places for so many further targets.")] = 0,
    over: Annotated[Over, Query(description="Headings that suggestions look at.")] = "worst",
) -> SuggestionOptions:
    """The part of the query that says whether more targets are to be suggested."""
    return SuggestionOptions(suggest, over)


def coverage_task(
    place: Annotated[SiteView, Depends(site_view)],
    phone: Annotated[PhoneWish, Depends(phone_wish)],
    wish: Annotated[ViewWish, Depends(view_wish)],
    suggestions: Annotated[SuggestionOptions, Depends(suggestion_wish)],
    format: Annotated[CoverageFormat, Query()] = "json",  # noqa: A002 - the query's name
) -> CoverageTask:
    """The whole query.

    Raises
    ------
    InvalidInput
        When its parameters contradict each other.
    """
    if suggestions.count and not place.walls:
        raise InvalidInput("targets are suggested on walls: give outline or walls", field="suggest")
    return CoverageTask(place, phone, wish, suggestions, format)


WantedCoverage = Annotated[CoverageTask, Depends(coverage_task)]


def _described(width_px: int, height_px: int, focal_35mm: float | None) -> CalibratedCamera:
    """A phone by what its EXIF says, and as uncertain."""
    typical = phone_camera(width_px, height_px)
    focal_px = typical.fx_px if focal_35mm is None else focal_35mm / FILM_WIDTH_MM * max(width_px, height_px)
    middle_px = [(width_px - 1) / 2.0, (height_px - 1) / 2.0]
    return known_from(Camera(width_px, height_px, np.array([focal_px, focal_px, *middle_px, *[0.0] * 5])), "exif")


def _outline(text: str, height_m: float) -> list[Wall]:
    try:
        return walls_of_outline("outline", _places(text), "inwards", (0.0, height_m))
    except ValueError as error:
        raise InvalidInput(f"outline: {error}", field="outline") from None


def _places(text: str) -> Array:
    """Pairs of coordinates, shape (N, 2); the pattern has seen to their form."""
    return np.array([[float(number) for number in place.split(",")] for place in text.split()])
