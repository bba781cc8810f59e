"""Control and check points: what was listed, what the map says of them, and whether both agree."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from app.photogrammetry.report import AdjustmentReport, ControlRecord
from app.services.reporting.document import Column, Paragraph, Section, Table
from app.services.reporting.numbers import MISSING, fixed, metres, millimetres
from app.services.survey_report.material import ReportMaterial

Array = npt.NDArray[np.float64]

# Of three coordinates one exceeds three standard deviations once in 120 points.
DOUBTFUL_SIGMAS = 3.0
COLUMNS = (
    Column("Name", align="left"),
    Column("Role", align="left"),
    Column("Target"),
    Column("Dot", align="left"),
    *(Column(axis, "Listed, m") for axis in "XYZ"),
    Column("Sigma, mm"),
    *(Column(axis, "Residual, mm") for axis in ("X", "Y", "Z", "3-D")),
    Column("Largest, sigmas"),
)
NOTE = (
    "Largest: the residual over its standard deviation, of the axis where it is greatest; a control point's standard "
    "deviation is the list's, a check point's holds the map's as well. Check points took no part in the adjustment."
)


def points(material: ReportMaterial) -> Section:
    """All control and check points."""
    report = material.report
    if not report.control:
        return Section("Control and check points", (Paragraph("No points were given."),))
    rows = tuple(_row(point, report) for point in report.control)
    doubtful = doubtful_points(report)
    marked = frozenset(index for index, point in enumerate(report.control) if point.name in doubtful)
    note = " ".join([NOTE, *_rmse_by_axis(report)])
    return Section(
        "Control and check points", (Table("Listed coordinates and residuals", COLUMNS, rows, note, marked),)
    )


def doubtful_points(report: AdjustmentReport) -> list[str]:
    """Names of the points whose residual is larger than its sigmas let expect."""
    judged = [(point.name, largest_sigmas(point, report)) for point in report.control]
    return [name for name, sigmas in judged if sigmas is not None and sigmas > DOUBTFUL_SIGMAS]


def largest_sigmas(point: ControlRecord, report: AdjustmentReport) -> float | None:
    """A point's largest residual in standard deviations; None when it was not measured."""
    if point.residual_m is None:
        return None
    sigma_m = np.full(3, point.sigma_m)
    if point.role == "check":
        own = [target.sigma_m for target in report.targets if target.code == point.code]
        if not own:  # its target carries the point and is too weakly seen for the map
            return None
        sigma_m = np.hypot(sigma_m, own[0])
    return float(np.abs(point.residual_m / sigma_m).max())


def _row(point: ControlRecord, report: AdjustmentReport) -> tuple[str, ...]:
    listed = (point.name, point.role, str(point.code), point.dot, *map(metres, point.position_m))
    if point.residual_m is None:
        return (*listed, millimetres(point.sigma_m), *[MISSING] * 4, "not in the map")
    residuals = (*map(millimetres, point.residual_m), millimetres(float(np.linalg.norm(point.residual_m))))
    return (*listed, millimetres(point.sigma_m), *residuals, fixed(largest_sigmas(point, report), 1))


def _rmse_by_axis(report: AdjustmentReport) -> list[str]:
    """A sentence for each role."""
    told = []
    for role in ("control", "check"):
        residuals_m = [p.residual_m for p in report.control if p.role == role and p.residual_m is not None]
        if residuals_m:
            x, y, z = (millimetres(value) for value in _root_mean_square(np.array(residuals_m)))
            told.append(f"Root mean square of {len(residuals_m)} {role} points: X {x}, Y {y}, Z {z} mm.")
    return told


def _root_mean_square(residuals_m: Array) -> Array:
    return np.asarray(np.sqrt((residuals_m**2).mean(axis=0)))
