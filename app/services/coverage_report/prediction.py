"""One prediction as it is asked for: a map, walls, a camera and a wish -> coverage, suggestions, a file."""

from __future__ import annotations

import json
from dataclasses import dataclass
from typing import Literal

from app.geometry.target_map import TargetMap
from app.planning.coverage import Progress, predict_coverage
from app.planning.plan_view import ViewWish
from app.planning.plan_walls import Wall
from app.planning.predicted_views import Seeing
from app.planning.suggestions import Suggestion, SuggestionOptions, suggest_targets
from app.services.coverage_report.heat_map import PlanMaterial, describe, draw_heat_map
from app.services.coverage_report.record import coverage_record
from app.services.reporting.picture import png_file, svg_file

CoverageFormat = Literal["json", "svg", "png"]
FORMATS: tuple[CoverageFormat, ...] = ("json", "svg", "png")


@dataclass(frozen=True)
class Prediction:
    """What is to be predicted.

    Attributes
    ----------
    title : str
    target_map : TargetMap
    walls : tuple of Wall
    seeing : Seeing
    wish : ViewWish
    suggestions : SuggestionOptions
        With a count of 0 nothing is suggested.
    """

    title: str
    target_map: TargetMap
    walls: tuple[Wall, ...]
    seeing: Seeing
    wish: ViewWish
    suggestions: SuggestionOptions = SuggestionOptions(count=0)


def predict(asked: Prediction, progress: Progress | None = None) -> PlanMaterial:
    """Coverage, and suggestions where some are asked for.

    Raises
    ------
    InvalidInput
        As ``predict_coverage`` and ``suggest_targets``.
    """
    coverage = predict_coverage(asked.target_map, asked.walls, asked.seeing, asked.wish, progress)
    suggested: tuple[Suggestion, ...] = ()
    if asked.suggestions.count > 0:
        suggested = suggest_targets(asked.target_map, asked.walls, asked.seeing, asked.wish, asked.suggestions)
    return PlanMaterial(
        title=asked.title,
        subtitle=_subtitle(asked),
        coverage=coverage,
        target_map=asked.target_map,
        walls=asked.walls,
        least_targets=asked.seeing.limits.min_targets,
        suggestions=suggested,
    )


def prediction_file(asked: Prediction, material: PlanMaterial, format_name: CoverageFormat) -> bytes:
    """The prediction as the bytes of a file."""
    if format_name == "json":
        return json.dumps(coverage_record(material, asked.seeing, asked.wish)).encode()
    drawing = draw_heat_map(material)
    return svg_file(drawing, describe(material)) if format_name == "svg" else png_file(drawing)


def _subtitle(asked: Prediction) -> str:
    """What the colours mean, and of what."""
    camera, limits, targets = asked.seeing.camera.camera, asked.seeing.limits, asked.target_map.targets
    size = f"{camera.width_px} x {camera.height_px} px, f = {camera.fx_px:.0f} px"
    return (
        f"Radius that holds 95 % of positions (3-D). Camera {asked.wish.height_m:g} m up, {size}; {asked.seeing.light} "
        f"light; {len(targets)} targets, from {limits.min_px_per_u:g} px per u, up to {limits.max_incidence_deg:g}°."
    )
