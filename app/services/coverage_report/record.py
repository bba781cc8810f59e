"""Predicted accuracy as a JSON-ready record."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from app.planning.plan_view import ViewWish
from app.planning.predicted_views import Seeing
from app.planning.suggestions import Standing, Suggestion
from app.services.coverage_report.heat_map import PlanMaterial

Array = npt.NDArray[np.float64]

FORMAT = "scattermark-coverage-1"
METRES_DIGITS = 5  # a hundredth of a millimetre
DEGREES_DIGITS = 3


def coverage_record(material: PlanMaterial, seeing: Seeing, wish: ViewWish) -> dict[str, Any]:
    """All positions with their best, middle and worst heading; null where a camera would not be located."""
    coverage, camera = material.coverage, seeing.camera
    return {
        "format": FORMAT,
        "title": material.title,
        "height_m": wish.height_m,
        "step_m": wish.step_m,
        "pitch_deg": wish.pitch_deg,
        "upright": wish.upright,
        "headings_deg": _rounded(np.degrees(coverage.headings_rad), DEGREES_DIGITS),
        "camera": {
            "width_px": camera.camera.width_px,
            "height_px": camera.camera.height_px,
            "focal_px": camera.camera.fx_px,
            "focal_sigma_px": float(np.sqrt(camera.covariance[0, 0])),
            "source": camera.source,
        },
        "light": seeing.light,
        "limits": {
            "min_px_per_u": seeing.limits.min_px_per_u,
            "max_incidence_deg": seeing.limits.max_incidence_deg,
            "min_targets": seeing.limits.min_targets,
        },
        "targets": len(material.target_map.targets),
        "summary": {
            "positions": len(coverage.best_m),
            "best": _summary(coverage.best_m),
            "middle": _summary(coverage.middle_m),
            "worst": _summary(coverage.worst_m),
        },
        "positions": [_position(material, index) for index in range(len(coverage.best_m))],
        "suggestions": [_suggestion(suggestion) for suggestion in material.suggestions],
    }


def _position(material: PlanMaterial, index: int) -> dict[str, Any]:
    coverage = material.coverage
    radii_m, best = coverage.radii95_m[index], int(coverage.radii95_m[index].argmin())
    located = bool(np.isfinite(radii_m[best]))
    return {
        "position_m": _rounded(coverage.grid.positions_m[index], METRES_DIGITS),
        "best_m": _number(coverage.best_m[index]),
        "best_heading_deg": round(float(np.degrees(coverage.headings_rad[best])), DEGREES_DIGITS) if located else None,
        "best_sigma_m": _rounded(coverage.sigmas_m[index, best], METRES_DIGITS) if located else None,
        "middle_m": _number(coverage.middle_m[index]),
        "worst_m": _number(coverage.worst_m[index]),
        "located_share": round(float(coverage.located_share[index]), 4),
        "targets": coverage.targets[index].tolist(),
        "radii95_m": [_number(radius_m) for radius_m in radii_m],
    }


def _summary(radii_m: Array) -> dict[str, Any]:
    finite = radii_m[np.isfinite(radii_m)]
    low, middle, high = np.quantile(finite, [0.05, 0.5, 0.95]) if len(finite) else [np.inf] * 3
    return {
        "located_share": round(len(finite) / len(radii_m), 4),
        "p5_m": _number(low),
        "median_m": _number(middle),
        "p95_m": _number(high),
        "greatest_m": _number(finite.max() if len(finite) else np.inf),
    }


def _suggestion(suggestion: Suggestion) -> dict[str, Any]:
    pose = suggestion.place.posted.site_from_target
    return {
        "wall": suggestion.place.wall,
        "at_m": _rounded(suggestion.place.at_m, METRES_DIGITS),
        "position_m": _rounded(pose.position_m, METRES_DIGITS),
        "normal": _rounded(pose.rotation[:, 2], METRES_DIGITS),
        "code": suggestion.place.posted.code,
        "before": _standing(suggestion.before),
        "after": _standing(suggestion.after),
    }


def _standing(standing: Standing) -> dict[str, Any]:
    return {"lacking": standing.lacking, "worst_m": _number(standing.worst_m), "rms_m": _number(standing.rms_m)}


def _number(value: float) -> float | None:
    """A number as JSON knows it; null for infinity."""
    return round(float(value), METRES_DIGITS) if np.isfinite(value) else None


def _rounded(values: Array, digits: int) -> list[float]:
    return [round(float(value), digits) + 0.0 for value in values]
